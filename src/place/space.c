// Finds the space that matters to a viewer: flooded through free voxels from the cameras, or judged by depth and light
// where no camera can enter.
#include "place/space.h"

#include "core/hooks.h"
#include "core/parallel.h"
#include "core/result.h"
#include "core/sampling.h"
#include "place/outdoors.h"
#include "scene/bvh.h"
#include "scene/emitters.h"

#include <string.h>

#define SOLID UINT32_MAX
#define LEAST_INDOORS 0.05f // of all space that is reached
enum {
  CAMERA_RAYS = 48,      // along the height and width of the picture of a camera outside the box
  MAX_COMPONENTS = 64,   // separate free spaces that are judged, the largest ones
  SAMPLES = 24,          // places of each, or of all the space that matters, that are judged
  LIGHT_DRAWS = 4,       // of each group of lights at such a place
  PLACES_A_JOB = 1 << 14 // voxels
};

// A probe keeps so many voxels from surfaces; the centres of free voxels always do.
#define LEAST_CLEARANCE 0.499f

static bool box_contains(const olx_box *box, olx_vec3 p) {
  return p.x >= box->min.x && p.y >= box->min.y && p.z >= box->min.z && p.x <= box->max.x && p.y <= box->max.y &&
         p.z <= box->max.z;
}

bool olx_rules_allow(const olx_scene *scene, olx_vec3 p) {
  const olx_probe_rules *rules = &scene->probe_rules;
  if (rules->has_playable && !box_contains(&rules->playable, p)) return false;
  for (uint32_t i = 0; i < rules->forbidden_count; i++) {
    if (box_contains(&rules->forbidden[i], p)) return false;
  }
  return rules->min_distance <= 0.0f || olx_bvh_distance(scene->bvh, p, rules->min_distance) >= rules->min_distance;
}

bool olx_space_allows(const olx_space *space, olx_vec3 p) {
  const float least = LEAST_CLEARANCE * space->voxels.size;
  return olx_space_reaches(space, p) && box_contains(&space->box, p) && olx_rules_allow(space->scene, p) &&
         olx_bvh_distance(space->scene->bvh, p, least) >= least;
}

bool olx_space_is_inside_geometry(const olx_space *space, olx_vec3 p) {
  olx_depth depth = {0};
  return olx_measure_depth(space->scene, &p, 1, 1, &depth) != OLX_OK || olx_depth_is_behind(depth, space->outside);
}

// Finding the space: labels are SOLID, 0 for free voxels not flooded yet, or a component's number from 1.
typedef struct finder {
  const olx_scene *scene;
  const olx_voxels *voxels;
  uint32_t *labels;
  size_t *stack;
} finder;

static bool sees(const olx_scene *scene, olx_vec3 from, olx_vec3 to) {
  const olx_ray ray = {from, olx_sub(to, from), 0.0f, 1.0f};
  return !olx_bvh_occluded(scene->bvh, &ray);
}

// Flood from the free voxel nearest to the eye, among those around it that it sees.
static size_t enter_here(const finder *f, olx_vec3 eye) {
  const olx_voxels *v = f->voxels;
  size_t nearest = OLX_NO_VOXEL;
  float nearest_distance = INFINITY;
  for (int32_t i = 0; i < 343; i++) {
    const olx_vec3 step = {(float)(i % 7 - 3), (float)(i / 7 % 7 - 3), (float)(i / 49 - 3)};
    const size_t voxel = olx_voxel_at(v, olx_madd(eye, step, v->size));
    if (voxel == OLX_NO_VOXEL || f->labels[voxel] == SOLID) continue;
    const olx_vec3 centre = olx_voxel_centre(v, voxel);
    const float distance = olx_length(olx_sub(centre, eye));
    if (distance >= nearest_distance || !sees(f->scene, eye, centre)) continue;
    nearest = voxel;
    nearest_distance = distance;
  }
  return nearest == OLX_NO_VOXEL ? 0 : olx_voxels_flood(v, nearest, 1, f->labels, f->stack);
}

// Flood from every free voxel that a camera outside the box sees.
static size_t enter_by_looking(const finder *f, const olx_camera *camera) {
  const olx_vec3 forward = olx_normalize(olx_sub(camera->target, camera->eye));
  const olx_vec3 right = olx_normalize(olx_cross(forward, camera->up)), up = olx_cross(right, forward);
  const float half = tanf(0.5f * camera->fov_y_degrees * OLX_PI / 180.0f);
  size_t flooded = 0;
  for (uint32_t i = 0; i < CAMERA_RAYS * CAMERA_RAYS; i++) {
    const float x = ((float)(i % CAMERA_RAYS) + 0.5f) * (2.0f / CAMERA_RAYS) - 1.0f;
    const float y = ((float)(i / CAMERA_RAYS) + 0.5f) * (2.0f / CAMERA_RAYS) - 1.0f;
    const olx_vec3 direction = olx_normalize(olx_madd(olx_madd(forward, right, x * half), up, y * half));
    float enter = 0.0f, leave = INFINITY;
    if (!olx_voxels_clip(f->voxels, camera->eye, direction, &enter, &leave)) continue;
    const olx_ray ray = {camera->eye, direction, 0.0f, INFINITY};
    const olx_ray_hit hit = olx_bvh_intersect(f->scene->bvh, &ray);
    if (hit.triangle != OLX_NO_HIT) leave = olx_min(leave, hit.t);
    for (float t = enter + 0.25f * f->voxels->size; t < leave; t += 0.5f * f->voxels->size) {
      const size_t voxel = olx_voxel_at(f->voxels, olx_madd(camera->eye, direction, t));
      if (voxel != OLX_NO_VOXEL && f->labels[voxel] == 0) {
        flooded += olx_voxels_flood(f->voxels, voxel, 1, f->labels, f->stack);
      }
    }
  }
  return flooded;
}

static size_t flood_from_cameras(const finder *f) {
  size_t flooded = 0;
  for (uint32_t i = 0; i < f->scene->camera_count; i++) {
    const olx_camera *camera = &f->scene->cameras[i];
    const bool within = olx_voxel_at(f->voxels, camera->eye) != OLX_NO_VOXEL;
    flooded += within ? enter_here(f, camera->eye) : enter_by_looking(f, camera);
  }
  return flooded;
}

// A connected free space.
typedef struct component {
  uint32_t label, sampled;
  size_t size;
  bool inside, lit;
  olx_vec3 samples[SAMPLES];
} component;

static uint32_t add_component(component *list, uint32_t count, uint32_t label, size_t size) {
  uint32_t at = count < MAX_COMPONENTS ? count++ : MAX_COMPONENTS - 1;
  if (at == MAX_COMPONENTS - 1 && list[at].size >= size) return count;
  for (; at > 0 && list[at - 1].size < size; at--) list[at] = list[at - 1];
  list[at] = (component){.label = label, .size = size};
  return count;
}

// Evenly spread voxels of each component, in the order of their indices.
static void sample_components(const finder *f, component *list, uint32_t count, size_t *seen) {
  for (uint32_t i = 0; i < count; i++) seen[list[i].label] = 0;
  for (size_t voxel = 0; voxel < f->voxels->total; voxel++) {
    const uint32_t label = f->labels[voxel];
    if (label == SOLID || label == 0) continue;
    for (uint32_t i = 0; i < count; i++) {
      component *c = &list[i];
      if (c->label != label) continue;
      const size_t wanted = (2 * (size_t)c->sampled + 1) * c->size / (2 * SAMPLES);
      if (seen[label]++ >= wanted && c->sampled < SAMPLES)
        c->samples[c->sampled++] = olx_voxel_centre(f->voxels, voxel);
    }
  }
}

static bool light_reaches(const olx_scene *scene, olx_vec3 p, uint32_t seed) {
  for (uint32_t group = 0; group < olx_emitters_group_count(scene); group++) {
    for (uint32_t draw = 0; draw < LIGHT_DRAWS; draw++) {
      const uint32_t key = olx_hash3(seed, group, draw);
      const olx_vec2 random = {olx_unit_float(olx_hash(key)), olx_unit_float(olx_hash(key + 1u))};
      olx_light_sample light;
      if (!olx_emitters_sample(scene, group, p, random, olx_unit_float(olx_hash(key + 2u)), &light)) continue;
      const float length = olx_length(olx_sub(light.target, p)) - light.epsilon_end;
      const olx_ray ray = {p, light.direction, 0.0f, light.infinite ? INFINITY : length};
      if (!olx_bvh_occluded(scene->bvh, &ray)) return true;
    }
  }
  return false;
}

static olx_result judge_components(const finder *f, component *list, uint32_t count, uint32_t threads,
                                   int32_t outside) {
  const size_t most = (size_t)count * SAMPLES;
  olx_vec3 *places = olx_allocate(most, sizeof *places);
  olx_depth *depths = olx_allocate(most, sizeof *depths);
  uint32_t total = 0;
  olx_result result = OLX_ERROR_MEMORY;
  if (places && depths) {
    for (uint32_t i = 0; i < count; i++) {
      memcpy(places + total, list[i].samples, list[i].sampled * sizeof *places);
      total += list[i].sampled;
    }
    result = olx_measure_depth(f->scene, places, total, threads, depths);
  } else {
    olx_fail(result, "place: out of memory");
  }
  for (uint32_t i = 0, at = 0; result == OLX_OK && i < count; i++) {
    uint32_t buried = 0;
    for (uint32_t k = 0; k < list[i].sampled; k++, at++) {
      buried += olx_depth_is_inside(depths[at], outside);
      list[i].lit = list[i].lit || light_reaches(f->scene, list[i].samples[k], at);
    }
    list[i].inside = 2 * buried > list[i].sampled;
  }
  olx_release(places);
  olx_release(depths);
  return result;
}

// Label 1 becomes the space that matters, when no camera says which: with a playable box every component that is not
// inside geometry, else the largest of them that light reaches, or the largest when light reaches none.
static void choose_components(const finder *f, const component *list, uint32_t count, uint8_t *chosen) {
  const component *best = NULL;
  for (uint32_t i = 0; i < count; i++) {
    if (list[i].inside) continue;
    if (f->scene->probe_rules.has_playable) chosen[list[i].label] = 1;
    else if (!best || (list[i].lit && !best->lit)) best = &list[i];
  }
  if (best) chosen[best->label] = 1;
}

static olx_result flood_everything(const finder *f, uint32_t threads, int32_t outside) {
  component *list = olx_allocate_zero(MAX_COMPONENTS, sizeof *list);
  uint32_t count = 0, labels = 0;
  for (size_t voxel = 0; list && voxel < f->voxels->total; voxel++) {
    if (f->labels[voxel] != 0) continue;
    const size_t size = olx_voxels_flood(f->voxels, voxel, ++labels, f->labels, f->stack);
    count = add_component(list, count, labels, size);
  }
  size_t *seen = olx_allocate((size_t)labels + 1, sizeof *seen);
  uint8_t *chosen = olx_allocate_zero((size_t)labels + 1, 1);
  olx_result result = OLX_ERROR_MEMORY;
  if (list && seen && chosen) {
    sample_components(f, list, count, seen);
    result = judge_components(f, list, count, threads, outside);
  } else {
    olx_fail(result, "place: out of memory");
  }
  if (result == OLX_OK) {
    choose_components(f, list, count, chosen);
    for (size_t voxel = 0; voxel < f->voxels->total; voxel++) {
      if (f->labels[voxel] != SOLID) f->labels[voxel] = chosen[f->labels[voxel]];
    }
  }
  olx_release(list);
  olx_release(seen);
  olx_release(chosen);
  return result;
}

// Which voxels allow a probe at their centre.
static void allow_job(void *user, uint32_t index) {
  olx_space *space = user;
  const olx_voxels *v = &space->voxels;
  const size_t first = (size_t)index * PLACES_A_JOB;
  for (size_t i = first; i < first + PLACES_A_JOB && i < v->total; i++) {
    const olx_vec3 centre = olx_voxel_centre(v, i);
    if (space->reachable[i] && box_contains(&space->box, centre) && olx_rules_allow(space->scene, centre)) {
      space->reachable[i] |= OLX_ALLOWED;
    }
  }
}

// The voxel beyond a face: along axis face / 2, back when face is even. OLX_NO_VOXEL at the border.
static size_t beyond_face(const olx_voxels *v, size_t voxel, uint32_t face) {
  const size_t stride[3] = {1, v->count[0], (size_t)v->count[0] * v->count[1]};
  const uint32_t axis = face / 2;
  uint32_t c[3];
  olx_voxel_coordinates(v, voxel, c);
  if (face & 1) return c[axis] + 1 < v->count[axis] ? voxel + stride[axis] : OLX_NO_VOXEL;
  return c[axis] > 0 ? voxel - stride[axis] : OLX_NO_VOXEL;
}

static void mark_fringe(olx_space *space) {
  const olx_voxels *v = &space->voxels;
  for (size_t i = 0; i < v->total; i++) {
    for (uint32_t face = 0; v->solid[i] && face < 6; face++) {
      const size_t other = beyond_face(v, i, face);
      if (other != OLX_NO_VOXEL && space->reachable[other] & OLX_REACHABLE) space->reachable[i] = OLX_FRINGE;
    }
  }
}

bool olx_space_draw(const olx_space *space, size_t nth, uint32_t seed, olx_vec3 *place) {
  const olx_voxels *v = &space->voxels;
  const size_t voxel = space->starts[nth];
  const olx_vec3 within = {olx_unit_float(olx_hash(seed)), olx_unit_float(olx_hash(seed + 1u)),
                           olx_unit_float(olx_hash(seed + 2u))};
  *place = olx_madd(olx_voxel_centre(v, voxel), olx_sub(within, olx_splat(0.5f)), v->size);
  if (!box_contains(&space->box, *place)) return false;
  if (space->reachable[voxel] & OLX_REACHABLE) return true;
  for (uint32_t face = 0; face < 6; face++) {
    const size_t other = beyond_face(v, voxel, face);
    if (other == OLX_NO_VOXEL || !(space->reachable[other] & OLX_REACHABLE)) continue;
    if (sees(space->scene, olx_voxel_centre(v, other), *place)) return true;
  }
  return false;
}

static olx_result list_places(olx_space *space, uint32_t threads) {
  const size_t total = space->voxels.total;
  OLX_TRY(olx_parallel_for((uint32_t)((total + PLACES_A_JOB - 1) / PLACES_A_JOB), threads, allow_job, space, NULL, 0));
  mark_fringe(space);
  OLX_TRY(olx_check_cancelled());
  for (size_t i = 0; i < total; i++) {
    space->place_count += (space->reachable[i] & OLX_ALLOWED) != 0;
    space->start_count += space->reachable[i] != 0;
  }
  space->places = olx_allocate(space->place_count, sizeof *space->places);
  space->starts = olx_allocate(space->start_count, sizeof *space->starts);
  if (!space->places || !space->starts) return olx_fail(OLX_ERROR_MEMORY, "place: no memory for %zu voxels", total);
  size_t allowed = 0, starts = 0;
  for (size_t i = 0; i < total; i++) {
    if (space->reachable[i]) space->starts[starts++] = i;
    if (space->reachable[i] & OLX_ALLOWED) space->places[allowed++] = i;
  }
  return OLX_OK;
}

// Flood from the cameras, else everything; `excluded` voxels count as solid.
static olx_result flood(olx_space *space, finder *f, const uint8_t *excluded, uint32_t threads) {
  const olx_voxels *v = &space->voxels;
  for (size_t i = 0; i < v->total; i++) f->labels[i] = v->solid[i] || (excluded && excluded[i]) ? SOLID : 0;
  const bool by_camera = flood_from_cameras(f) > 0;
  OLX_TRY(olx_check_cancelled());
  if (!by_camera) OLX_TRY(flood_everything(f, threads, space->outside));
  space->reachable_count = 0;
  for (size_t i = 0; i < v->total; i++) {
    space->reachable[i] = f->labels[i] == 1 ? OLX_REACHABLE : 0;
    space->reachable_count += f->labels[i] == 1;
  }
  return OLX_OK;
}

// Without a playable box, what is behind the scenery does not matter, unless hardly anything else is left.
static olx_result leave_outdoors(olx_space *space, finder *f, uint32_t threads) {
  const size_t total = space->voxels.total;
  const size_t before = space->reachable_count;
  uint8_t *excluded = olx_allocate(total, 1), *whole = olx_allocate(total, 1);
  size_t count = 0;
  olx_result result = OLX_ERROR_MEMORY;
  if (excluded && whole) {
    memcpy(whole, space->reachable, total);
    result = olx_find_outdoors(space, threads, excluded, &count);
  } else {
    olx_fail(result, "place: no memory for %zu voxels", total);
  }
  if (result == OLX_OK && count > 0) {
    result = flood(space, f, excluded, threads);
    if (result == OLX_OK && (float)space->reachable_count < LEAST_INDOORS * (float)before) {
      memcpy(space->reachable, whole, total);
      space->reachable_count = before;
    }
  }
  olx_release(excluded);
  olx_release(whole);
  return result;
}

static olx_result find_space(olx_space *space, finder *f, uint32_t threads) {
  const olx_voxels *v = &space->voxels;
  size_t free_voxels = 0;
  for (size_t i = 0; i < v->total; i++) free_voxels += !v->solid[i];
  if (free_voxels == 0) {
    return olx_fail(OLX_ERROR_EMPTY, "nowhere to place probes: surfaces touch every voxel of %g m; try more voxels",
                    (double)v->size);
  }
  OLX_TRY(olx_find_outside(space->scene, threads, &space->outside, NULL));
  OLX_TRY(flood(space, f, NULL, threads));
  OLX_TRY(olx_check_cancelled());
  if (!space->scene->probe_rules.has_playable) OLX_TRY(leave_outdoors(space, f, threads));
  if (space->reachable_count == 0) {
    return olx_fail(OLX_ERROR_EMPTY, "nowhere to place probes: every free place in %s is inside geometry",
                    space->scene->probe_rules.has_playable ? "the playable box" : "the scene's bounds");
  }
  return list_places(space, threads);
}

// The box to look at: the playable one, as far as it is near the scene, or the scene's bounds.
static olx_result choose_box(const olx_scene *scene, olx_box *box) {
  const olx_probe_rules *rules = &scene->probe_rules;
  *box = (olx_box){scene->bounds_min, scene->bounds_max};
  const float diagonal = olx_length(olx_sub(box->max, box->min));
  if (rules->has_playable) {
    box->min = olx_max_each(rules->playable.min, olx_add(box->min, olx_splat(-diagonal)));
    box->max = olx_min_each(rules->playable.max, olx_add(box->max, olx_splat(diagonal)));
  }
  const olx_vec3 extent = olx_sub(box->max, box->min);
  if (extent.x > 0.0f && extent.y > 0.0f && extent.z > 0.0f) return OLX_OK;
  if (!rules->has_playable) {
    return olx_fail(OLX_ERROR_EMPTY,
                    "nowhere to place probes: the scene is flat, its bounds hold no volume; a playable "
                    "box in its description can say where to look");
  }
  return olx_fail(OLX_ERROR_EMPTY, "nowhere to place probes: the playable box holds no volume near the scene");
}

olx_result olx_space_create(const olx_scene *scene, uint32_t resolution, uint32_t threads, olx_space *space) {
  *space = (olx_space){.scene = scene};
  OLX_TRY(choose_box(scene, &space->box));
  OLX_TRY(olx_voxels_create(scene, space->box, resolution, threads, &space->voxels));
  const size_t total = space->voxels.total;
  finder f = {.scene = scene,
              .voxels = &space->voxels,
              .labels = olx_allocate(total, sizeof *f.labels),
              .stack = olx_allocate(total, sizeof *f.stack)};
  space->reachable = olx_allocate(total, 1);
  olx_result result = OLX_ERROR_MEMORY;
  if (f.labels && f.stack && space->reachable) result = find_space(space, &f, threads);
  else olx_fail(result, "place: no memory for %zu voxels", total);
  olx_release(f.labels);
  olx_release(f.stack);
  if (result != OLX_OK) olx_space_free(space);
  return result;
}

void olx_space_free(olx_space *space) {
  olx_voxels_free(&space->voxels);
  olx_release(space->reachable);
  olx_release(space->places);
  olx_release(space->starts);
  space->reachable = NULL;
  space->starts = NULL;
  space->places = NULL;
}
