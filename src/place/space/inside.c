// Measures how deep positions are inside surfaces by counting front and back faces along rays, and finds the depth that
// counts as outside in a scene.
#include "place/space/inside.h"

#include "core/hooks.h"
#include "core/octahedral.h"
#include "core/parallel.h"
#include "core/result.h"
#include "scene/bvh.h"

enum {
  MAP_SIZE = 16,   // rays along a side of the map by which back faces are found
  DIRECTIONS = 33, // directions in which crossings are counted; odd, for the median
  CROSSINGS = 512, // most crossings that are counted in a direction
  LOOK_SIDE = 4,   // rays along the height and the width of a camera's image that find free positions
  LATTICE_SIDE = 6 // positions along each axis of the box for probes, where no camera shows what is free
};

typedef struct depth_search {
  const olx_scene *scene;
  const olx_vec3 *positions;
  olx_depth *depths;
} depth_search;

bool olx_faces_away(const olx_scene *scene, uint32_t triangle, olx_vec3 direction) {
  const uint32_t *corner = scene->indices + 3 * (size_t)triangle;
  const olx_vec3 a = scene->positions[corner[0]], b = scene->positions[corner[1]], c = scene->positions[corner[2]];
  return olx_dot(olx_cross(olx_sub(b, a), olx_sub(c, a)), direction) > 0.0f;
}

static void look_around(const olx_scene *scene, olx_vec3 position, olx_depth *depth) {
  olx_ray rays[MAP_SIZE];
  olx_ray_hit hits[MAP_SIZE];
  double back = 0.0, sky = 0.0;
  for (uint32_t y = 0; y < MAP_SIZE; y++) {
    for (uint32_t x = 0; x < MAP_SIZE; x++) {
      rays[x] = (olx_ray){position, olx_texel_direction(x, y, MAP_SIZE), 0.0f, INFINITY};
    }
    olx_bvh_intersect_many(scene->bvh, rays, MAP_SIZE, true, hits);
    for (uint32_t x = 0; x < MAP_SIZE; x++) {
      const double angle = olx_texel_solid_angle(x, y, MAP_SIZE);
      if (hits[x].triangle == OLX_NO_HIT) sky += angle;
      else if (olx_faces_away(scene, hits[x].triangle, rays[x].direction)) back += angle;
    }
  }
  depth->back_share = (float)(back / (4.0 * (double)OLX_PI));
  depth->sky_share = (float)(sky / (4.0 * (double)OLX_PI));
}

// Returns the number of back faces minus that of front faces that a ray crosses until it leaves the scene.
static int32_t crossing_balance(const olx_scene *scene, olx_vec3 position, olx_vec3 direction, uint32_t *rays) {
  olx_ray ray = {position, direction, 0.0f, INFINITY};
  int32_t balance = 0;
  for (uint32_t i = 0; i < CROSSINGS; i++) {
    const olx_ray_hit hit = olx_bvh_intersect(scene->bvh, &ray);
    ++*rays;
    if (hit.triangle == OLX_NO_HIT) break;
    balance += olx_faces_away(scene, hit.triangle, direction) ? 1 : -1;
    ray.t_min = nextafterf(hit.t, INFINITY);
  }
  return balance;
}

static int32_t median_balance(const olx_scene *scene, olx_vec3 position, uint32_t *rays) {
  int32_t sorted[DIRECTIONS];
  for (uint32_t i = 0; i < DIRECTIONS; i++) {
    // A spiral of evenly spread directions, none of which lies along an axis.
    const float y = 1.0f - (2.0f * (float)i + 1.0f) / DIRECTIONS, r = sqrtf(1.0f - y * y),
                phi = 2.3999632f * (float)i + 0.4f;
    const int32_t balance = crossing_balance(scene, position, olx_v3(r * cosf(phi), y, r * sinf(phi)), rays);
    uint32_t k = i;
    for (; k > 0 && sorted[k - 1] > balance; k--) sorted[k] = sorted[k - 1];
    sorted[k] = balance;
  }
  return sorted[DIRECTIONS / 2];
}

static void depth_job(void *user, uint32_t index) {
  const depth_search *s = user;
  olx_depth *d = &s->depths[index];
  d->rays = MAP_SIZE * MAP_SIZE;
  look_around(s->scene, s->positions[index], d);
  d->depth = median_balance(s->scene, s->positions[index], &d->rays);
}

olx_result olx_measure_depth(const olx_scene *scene, const olx_vec3 *positions, uint32_t count, uint32_t threads,
                             olx_depth *depths) {
  depth_search s = {.scene = scene, .positions = positions, .depths = depths};
  return olx_parallel_for(count, threads, depth_job, &s, NULL, 0);
}

// Positions that are known to be free, as far as the scene determines it.
typedef struct free_places {
  olx_vec3 *positions;
  uint32_t count;
} free_places;

// Adds the eye, and positions half way and near the end of view rays, within the scene's bounds.
static void look_from(const olx_scene *scene, const olx_camera *camera, free_places *found) {
  const olx_box bounds = {scene->bounds_min, scene->bounds_max};
  const olx_vec3 forward = olx_normalize(olx_sub(camera->target, camera->eye));
  const olx_vec3 right = olx_normalize(olx_cross(forward, camera->up)), up = olx_cross(right, forward);
  const float half = tanf(0.5f * camera->fov_y_degrees * OLX_PI / 180.0f);
  found->positions[found->count++] = camera->eye;
  for (uint32_t i = 0; i < LOOK_SIDE * LOOK_SIDE; i++) {
    const float x = ((float)(i % LOOK_SIDE) + 0.5f) * (2.0f / LOOK_SIDE) - 1.0f;
    const float y = ((float)(i / LOOK_SIDE) + 0.5f) * (2.0f / LOOK_SIDE) - 1.0f;
    const olx_vec3 direction = olx_normalize(olx_madd(olx_madd(forward, right, x * half), up, y * half));
    const olx_ray ray = {camera->eye, direction, 0.0f, INFINITY};
    const olx_ray_hit hit = olx_bvh_intersect(scene->bvh, &ray);
    if (hit.triangle == OLX_NO_HIT) continue;
    for (uint32_t k = 0; k < 2; k++) {
      const olx_vec3 place = olx_madd(camera->eye, direction, (k ? 0.9f : 0.5f) * hit.t);
      if (olx_box_holds(&bounds, place)) found->positions[found->count++] = place;
    }
  }
}

// Adds positions evenly spread over the box for probes: the playable one, otherwise the volume of probes, otherwise the
// bounds.
static void spread_over_box(const olx_scene *scene, free_places *found) {
  olx_box box = {scene->bounds_min, scene->bounds_max};
  if (scene->has_probe_volume) box = (olx_box){scene->probes_min, scene->probes_max};
  if (scene->probe_rules.has_playable) {
    const olx_box playable = scene->probe_rules.playable;
    box = (olx_box){olx_max_each(playable.min, scene->bounds_min), olx_min_each(playable.max, scene->bounds_max)};
  }
  const olx_vec3 step = olx_scale(olx_sub(box.max, box.min), 1.0f / LATTICE_SIDE);
  for (uint32_t i = 0; i < LATTICE_SIDE * LATTICE_SIDE * LATTICE_SIDE; i++) {
    const olx_vec3 cell = {(float)(i % LATTICE_SIDE) + 0.5f, (float)(i / LATTICE_SIDE % LATTICE_SIDE) + 0.5f,
                           (float)(i / (LATTICE_SIDE * LATTICE_SIDE)) + 0.5f};
    found->positions[found->count++] = olx_add(box.min, olx_mul(cell, step));
  }
}

olx_result olx_find_outside(const olx_scene *scene, uint32_t threads, int32_t *outside, uint64_t *rays) {
  const size_t a_camera = 1 + 2 * LOOK_SIDE * LOOK_SIDE, lattice = LATTICE_SIDE * LATTICE_SIDE * LATTICE_SIDE;
  const size_t most = scene->camera_count ? scene->camera_count * a_camera : lattice;
  free_places found = {.positions = olx_allocate(most, sizeof *found.positions)};
  olx_depth *depths = olx_allocate(most, sizeof *depths);
  olx_result result = OLX_ERROR_MEMORY;
  *outside = INT32_MAX;
  if (found.positions && depths) {
    for (uint32_t i = 0; i < scene->camera_count; i++) look_from(scene, &scene->cameras[i], &found);
    if (scene->camera_count == 0) spread_over_box(scene, &found);
    result = olx_measure_depth(scene, found.positions, found.count, threads, depths);
  } else {
    olx_fail(result, "out of memory for %zu places", most);
  }
  for (uint32_t i = 0; result == OLX_OK && i < found.count; i++) {
    if (depths[i].depth < *outside) *outside = depths[i].depth;
    if (rays) *rays += depths[i].rays;
  }
  olx_release(depths);
  olx_release(found.positions);
  return result;
}
