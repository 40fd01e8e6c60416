// Opens tiles of the space that matters as windows of single voxels, and determines where in them probes are allowed.
#include "place/space/space.h"

#include "core/hooks.h"
#include "core/parallel.h"
#include "core/result.h"
#include "core/sampling.h"
#include "scene/bvh.h"

enum { PLACES_A_JOB = 1 << 14 }; // in voxels

// Least distance of a probe from surfaces, in voxels; the centres of free voxels always keep it.
#define LEAST_CLEARANCE 0.499f

bool olx_rules_allow(const olx_scene *scene, olx_vec3 p) {
  const olx_probe_rules *rules = &scene->probe_rules;
  if (rules->has_playable && !olx_box_holds(&rules->playable, p)) return false;
  for (uint32_t i = 0; i < rules->forbidden_count; i++) {
    if (olx_box_holds(&rules->forbidden[i], p)) return false;
  }
  return rules->min_distance <= 0.0f || olx_bvh_distance(scene->bvh, p, rules->min_distance) >= rules->min_distance;
}

bool olx_space_allows(const olx_space *space, olx_vec3 p) {
  const float least = LEAST_CLEARANCE * space->voxels.size;
  return olx_space_reaches(space, p) && olx_box_holds(&space->box, p) && olx_rules_allow(space->scene, p) &&
         olx_bvh_distance(space->scene->bvh, p, least) >= least;
}

bool olx_space_is_inside_geometry(const olx_space *space, olx_vec3 p) {
  olx_depth depth = {0};
  return olx_measure_depth(space->scene, &p, 1, 1, &depth) != OLX_OK || olx_depth_is_behind(depth, space->outside);
}

// Finds the voxels that allow a probe at their centre.
static void allow_job(void *user, uint32_t index) {
  olx_space *space = user;
  const olx_voxels *v = &space->voxels;
  const size_t first = (size_t)index * PLACES_A_JOB;
  for (size_t i = first; i < first + PLACES_A_JOB && i < v->total; i++) {
    const olx_vec3 centre = olx_voxel_centre(v, i);
    if (space->reachable[i] && olx_box_holds(&space->box, centre) && olx_rules_allow(space->scene, centre)) {
      space->reachable[i] |= OLX_ALLOWED;
    }
  }
}

// Returns the voxel beyond a face: along axis face / 2, backwards when face is even. OLX_NO_VOXEL at the border.
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
  if (!olx_box_holds(&space->box, *place)) return false;
  if (space->reachable[voxel] & OLX_REACHABLE) return true;
  for (uint32_t face = 0; face < 6; face++) {
    const size_t other = beyond_face(v, voxel, face);
    if (other == OLX_NO_VOXEL || !(space->reachable[other] & OLX_REACHABLE)) continue;
    if (olx_bvh_is_clear(space->scene->bvh, olx_voxel_centre(v, other), *place)) return true;
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

static olx_result no_memory(const olx_space *space) {
  return olx_fail(OLX_ERROR_MEMORY, "place: no memory for %zu voxels", space->voxels.total);
}

static void lay_voxels(olx_space *space) {
  const olx_lattice *lattice = &space->world->lattice;
  const olx_tile *t = &space->tile;
  olx_voxels *v = &space->voxels;
  const olx_vec3 first = {(float)t->from[0], (float)t->from[1], (float)t->from[2]};
  v->size = lattice->size;
  v->low = olx_madd(lattice->low, first, lattice->size);
  v->total = 1;
  for (int axis = 0; axis < 3; axis++) v->total *= v->count[axis] = t->to[axis] - t->from[axis];
}

static void copy_layer(void *user, uint32_t z) {
  olx_space *space = user;
  const olx_voxels *v = &space->voxels;
  const uint32_t *from = space->tile.from;
  size_t at = (size_t)v->count[0] * v->count[1] * z;
  for (uint32_t y = 0; y < v->count[1]; y++) {
    for (uint32_t x = 0; x < v->count[0]; x++, at++) {
      const uint32_t voxel[3] = {from[0] + x, from[1] + y, from[2] + z};
      const olx_voxel_state state = olx_world_state(space->world, voxel);
      v->solid[at] = state == OLX_VOXEL_SOLID;
      space->reachable[at] = state == OLX_VOXEL_REACHED ? OLX_REACHABLE : 0;
    }
  }
}

static olx_result fill(olx_space *space, uint32_t threads) {
  olx_voxels *v = &space->voxels;
  v->solid = olx_allocate(v->total, sizeof *v->solid);
  v->distance = olx_allocate(v->total, sizeof *v->distance);
  space->reachable = olx_allocate(v->total, 1);
  if (!v->solid || !v->distance || !space->reachable) return no_memory(space);
  OLX_TRY(olx_parallel_for(v->count[2], threads, copy_layer, space, NULL, 0));
  for (size_t i = 0; i < v->total; i++) space->reachable_count += space->reachable[i];
  if (space->reachable_count == 0) return OLX_OK;
  OLX_TRY(olx_distance_transform(v->solid, v->count, threads, v->distance));
  return list_places(space, threads);
}

olx_result olx_space_open(olx_world *world, uint32_t tile, uint32_t overlap, uint32_t threads, olx_space *space) {
  *space = (olx_space){.scene = world->scene,
                       .world = world,
                       .tile = olx_world_tile(world, tile, overlap),
                       .box = world->box,
                       .outside = world->outside};
  lay_voxels(space);
  const olx_result result = fill(space, threads);
  if (result != OLX_OK) olx_space_free(space);
  return result;
}

void olx_space_free(olx_space *space) {
  olx_voxels_free(&space->voxels);
  olx_release(space->reachable);
  olx_release(space->places);
  olx_release(space->starts);
  if (space->owns_world) {
    olx_world_free(space->world);
    olx_release(space->world);
  }
  space->reachable = NULL;
  space->starts = NULL;
  space->places = NULL;
  space->world = NULL;
  space->owns_world = false;
}
