// Finds free space that lies behind the scenery, such as between a building's outer walls and the bounds of its model:
// cuts space into pieces and judges each by what rays from its middle meet.
#include "place/outdoors.h"

#include "core/hooks.h"
#include "core/parallel.h"
#include "core/result.h"
#include "core/sampling.h"
#include "scene/bvh.h"

#include <string.h>

#define INDOOR_SKY 0.25f    // share of directions that leave the scene: an indoor place sees less,
#define OUTDOOR_SKY 0.4f    // an outdoor place more;
#define INDOOR_PIECES 0.25f // of a scene without cameras that is indoors
enum { EDGE = 4, LOOKS = 64, PIECES_A_JOB = 32 };

// Connected voxels of a cube of them, judged by the one that is farthest from surfaces.
typedef struct piece {
  size_t voxel;
  float sky, back; // shares of directions
  bool outdoors;
} piece;

typedef struct pieces {
  const olx_space *space;
  uint32_t *of; // a voxel: its piece, NONE
  piece *items;
  uint32_t count, capacity;
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

// All that is connected with the voxel within its cube becomes a piece.
static void grow_piece(pieces *p, size_t seed) {
  const olx_voxels *v = &p->space->voxels;
  const size_t stride[3] = {1, v->count[0], (size_t)v->count[0] * v->count[1]};
  size_t stack[EDGE * EDGE * EDGE], used = 0;
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
      if (face & 1 ? c[axis] % EDGE == EDGE - 1 || c[axis] + 1 == v->count[axis] : c[axis] % EDGE == 0) continue;
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
  p->of = olx_allocate(total, sizeof *p->of);
  if (!p->of) return olx_fail(OLX_ERROR_MEMORY, "place: no memory for %zu voxels", total);
  for (size_t i = 0; i < total; i++) p->of[i] = NONE;
  for (size_t i = 0; i < total; i++) {
    if (!(p->space->reachable[i] & OLX_REACHABLE) || p->of[i] != NONE) continue;
    OLX_TRY(make_room(p));
    OLX_TRY(olx_check_cancelled());
    grow_piece(p, i);
  }
  return olx_parallel_for((p->count + PIECES_A_JOB - 1) / PIECES_A_JOB, threads, look_job, p, NULL, 0);
}

// Whether the viewer stays where little sky is seen.
static bool is_indoor(const pieces *p) {
  const olx_scene *scene = p->space->scene;
  uint32_t within = 0, indoor = 0;
  for (uint32_t i = 0; i < scene->camera_count; i++) {
    float sky, back;
    if (olx_voxel_at(&p->space->voxels, scene->cameras[i].eye) == OLX_NO_VOXEL) continue;
    look_from(scene, scene->cameras[i].eye, &sky, &back);
    within++;
    indoor += sky < INDOOR_SKY;
  }
  if (scene->camera_count > 0) return within > 0 && indoor == within;
  for (uint32_t i = 0; i < p->count; i++) indoor += p->items[i].sky < INDOOR_SKY;
  return (float)indoor >= INDOOR_PIECES * (float)p->count;
}

typedef struct judge {
  const pieces *of;
  bool indoor;
} judge;

static void judge_job(void *user, uint32_t index) {
  const judge *j = user;
  const olx_space *space = j->of->space;
  piece *one = &j->of->items[index];
  one->outdoors = j->indoor && one->sky >= OUTDOOR_SKY;
  if (one->outdoors || one->back <= 0.5f * (1.0f - one->sky)) return;
  const olx_vec3 place = olx_voxel_centre(&space->voxels, one->voxel);
  olx_depth depth;
  if (olx_measure_depth(space->scene, &place, 1, 1, &depth) == OLX_OK)
    one->outdoors = olx_depth_is_behind(depth, space->outside);
}

olx_result olx_find_outdoors(const olx_space *space, uint32_t threads, uint8_t *excluded, size_t *count) {
  pieces p = {.space = space};
  *count = 0;
  olx_result result = cut_pieces(&p, threads);
  if (result == OLX_OK) {
    judge j = {&p, is_indoor(&p)};
    result = olx_parallel_for(p.count, threads, judge_job, &j, NULL, 0);
  }
  for (size_t i = 0; result == OLX_OK && i < space->voxels.total; i++) {
    excluded[i] = p.of[i] != NONE && p.items[p.of[i]].outdoors;
    *count += excluded[i];
  }
  olx_release(p.of);
  olx_release(p.items);
  return result;
}
