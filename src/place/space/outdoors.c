// Finds free space behind the scenery, such as between a building's outer walls and the bounds of its model: divides
// space into pieces and classifies each by what rays from its middle hit.
#include "place/space/outdoors.h"

#include "core/hooks.h"
#include "core/parallel.h"
#include "core/result.h"
#include "core/sampling.h"
#include "scene/bvh.h"

#include <string.h>

#define INDOOR_SKY 0.25f // most sky visible from an indoor position, as a share of directions
enum {
  EDGE = 4,       // voxels along a piece
  TILES_EDGE = 8, // voxels along a piece in worlds of many tiles
  LOOKS = 64,
  PIECES_A_JOB = 32
};

// A connected set of voxels in a cube of them, classified by the voxel that is farthest from surfaces.
typedef struct piece {
  size_t voxel;
  float sky, back; // shares of directions
  bool outdoors;
} piece;

typedef struct pieces {
  const olx_space *space;
  uint32_t *of; // per voxel: its piece, or NONE
  piece *items;
  uint32_t count, capacity, edge;
} pieces;
#define NONE UINT32_MAX

static void look_from(const olx_scene *scene, olx_vec3 place, float *sky, float *back) {
  olx_ray rays[LOOKS];
  olx_ray_hit hits[LOOKS];
  uint32_t misses = 0, backs = 0;
  for (uint32_t i = 0; i < LOOKS; i++) {
    rays[i] = (olx_ray){place, olx_sample_sphere(olx_hammersley(i, LOOKS)), 0.0f, INFINITY};
  }
  olx_bvh_intersect_many(scene->bvh, rays, LOOKS, false, hits);
  for (uint32_t i = 0; i < LOOKS; i++) {
    if (hits[i].triangle == OLX_NO_HIT) misses++;
    else backs += olx_faces_away(scene, hits[i].triangle, rays[i].direction);
  }
  *sky = (float)misses / LOOKS;
  *back = (float)backs / LOOKS;
}

static void look_job(void *user, uint32_t index) {
  const pieces *p = user;
  for (uint32_t i = index * PIECES_A_JOB; i < (index + 1) * PIECES_A_JOB && i < p->count; i++) {
    piece *one = &p->items[i];
    look_from(p->space->scene, olx_voxel_centre(&p->space->voxels, one->voxel), &one->sky, &one->back);
  }
}

static bool is_core(const olx_space *space, const uint32_t c[3]) {
  for (int axis = 0; axis < 3; axis++) {
    const uint32_t at = c[axis] + space->tile.from[axis];
    if (at < space->tile.core_from[axis] || at >= space->tile.core_to[axis]) return false;
  }
  return true;
}

// Returns whether a step along the axis stays in the piece's cube. Cubes are aligned across tiles.
static bool stays(const pieces *p, const uint32_t c[3], int axis, bool forwards) {
  const uint32_t at = (c[axis] + p->space->tile.from[axis]) % p->edge;
  return forwards ? at != p->edge - 1 && c[axis] + 1 < p->space->voxels.count[axis] : at != 0;
}

// Makes a piece of everything that is connected with the voxel within its cube.
static void grow_piece(pieces *p, size_t seed) {
  const olx_voxels *v = &p->space->voxels;
  const size_t stride[3] = {1, v->count[0], (size_t)v->count[0] * v->count[1]};
  size_t stack[TILES_EDGE * TILES_EDGE * TILES_EDGE], used = 0;
  piece *one = &p->items[p->count];
  *one = (piece){.voxel = seed};
  p->of[seed] = p->count;
  stack[used++] = seed;
  while (used > 0) {
    const size_t voxel = stack[--used];
    uint32_t c[3];
    olx_voxel_coordinates(v, voxel, c);
    if (v->distance[voxel] > v->distance[one->voxel]) one->voxel = voxel;
    for (int face = 0; face < 6; face++) {
      const int axis = face / 2;
      if (!stays(p, c, axis, face & 1)) continue;
      const size_t other = face & 1 ? voxel + stride[axis] : voxel - stride[axis];
      if (!(p->space->reachable[other] & OLX_REACHABLE) || p->of[other] != NONE) continue;
      p->of[other] = p->count;
      stack[used++] = other;
    }
  }
  p->count++;
}

static olx_result make_room(pieces *p) {
  if (p->count < p->capacity) return OLX_OK;
  const uint32_t capacity = p->capacity ? 2 * p->capacity : 1024;
  piece *items = olx_allocate(capacity, sizeof *items);
  if (!items) return olx_fail(OLX_ERROR_MEMORY, "place: out of memory");
  if (p->count) memcpy(items, p->items, p->count * sizeof *items);
  olx_release(p->items);
  p->items = items;
  p->capacity = capacity;
  return OLX_OK;
}

static olx_result cut_pieces(pieces *p, uint32_t threads) {
  const size_t total = p->space->voxels.total;
  p->edge = p->space->world->tile_total > 1 ? TILES_EDGE : EDGE;
  p->of = olx_allocate(total, sizeof *p->of);
  if (!p->of) return olx_fail(OLX_ERROR_MEMORY, "place: no memory for %zu voxels", total);
  for (size_t i = 0; i < total; i++) p->of[i] = NONE;
  for (size_t i = 0; i < total; i++) {
    uint32_t c[3];
    if (!(p->space->reachable[i] & OLX_REACHABLE) || p->of[i] != NONE) continue;
    olx_voxel_coordinates(&p->space->voxels, i, c);
    if (!is_core(p->space, c)) continue;
    OLX_TRY(make_room(p));
    OLX_TRY(olx_check_cancelled());
    grow_piece(p, i);
  }
  return olx_parallel_for((p->count + PIECES_A_JOB - 1) / PIECES_A_JOB, threads, look_job, p, NULL, 0);
}

bool olx_cameras_are_indoors(const olx_world *world) {
  const olx_scene *scene = world->scene;
  for (uint32_t i = 0; i < scene->camera_count; i++) {
    float sky, back;
    look_from(scene, scene->cameras[i].eye, &sky, &back);
    if (sky >= INDOOR_SKY) return false;
  }
  return scene->camera_count > 0;
}

static void free_pieces(pieces *p) {
  olx_release(p->of);
  olx_release(p->items);
}

olx_result olx_count_indoors(const olx_space *space, uint32_t threads, uint64_t *count, uint64_t *indoor) {
  pieces p = {.space = space};
  const olx_result result = cut_pieces(&p, threads);
  *count += p.count;
  for (uint32_t i = 0; result == OLX_OK && i < p.count; i++) *indoor += p.items[i].sky < INDOOR_SKY;
  free_pieces(&p);
  return result;
}

typedef struct judge {
  const pieces *of;
  bool indoor;
} judge;

static void judge_job(void *user, uint32_t index) {
  const judge *j = user;
  const olx_space *space = j->of->space;
  piece *one = &j->of->items[index];
  one->outdoors = j->indoor && one->sky >= OLX_OUTDOOR_SKY;
  if (one->outdoors || one->back <= 0.5f * (1.0f - one->sky)) return;
  const olx_vec3 place = olx_voxel_centre(&space->voxels, one->voxel);
  olx_depth depth;
  if (olx_measure_depth(space->scene, &place, 1, 1, &depth) == OLX_OK)
    one->outdoors = olx_depth_is_behind(depth, space->outside);
}

olx_result olx_find_outdoors(const olx_space *space, bool indoors, uint32_t threads, uint8_t *excluded) {
  pieces p = {.space = space};
  olx_result result = cut_pieces(&p, threads);
  if (result == OLX_OK) {
    judge j = {&p, indoors};
    result = olx_parallel_for(p.count, threads, judge_job, &j, NULL, 0);
  }
  for (size_t i = 0; result == OLX_OK && i < space->voxels.total; i++) {
    excluded[i] = p.of[i] != NONE && p.items[p.of[i]].outdoors;
  }
  free_pieces(&p);
  return result;
}
