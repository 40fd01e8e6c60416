#include "place/inside.h"

#include "core/octahedral.h"
#include "core/parallel.h"
#include "scene/bvh.h"

enum {
  MAP_SIZE = 16,   // rays a side by which a place looks for back faces
  DIRECTIONS = 33, // in which crossings are counted; odd, for the median
  CROSSINGS = 512  // after which a direction is given up
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

// Back faces less front faces on the way out.
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
