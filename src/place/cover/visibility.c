// Computes which surfels are seen from which positions, and how well, by casting rays for batches of positions and
// surfels.
#include "place/cover/visibility.h"

#include "scene/bvh.h"

#include <string.h>

enum { BATCH = 256 };

static olx_ray ray_between(olx_vec3 place, const olx_surfel *surfel) {
  return (olx_ray){place, olx_sub(surfel->position, place), 0.0f, 1.0f};
}

void olx_sight_row(const olx_space *space, const olx_sight *sight, olx_vec3 place, const olx_surfels *surfels,
                   uint8_t *quality) {
  olx_ray rays[BATCH];
  uint32_t who[BATCH], used = 0;
  uint8_t occluded[BATCH];
  for (uint32_t i = 0; i < surfels->count; i++) {
    quality[i] = olx_sight_quality(sight, place, &surfels->items[i]);
    if (quality[i]) {
      rays[used] = ray_between(place, &surfels->items[i]);
      who[used++] = i;
    }
    if (used < BATCH && i + 1 < surfels->count) continue;
    olx_bvh_occluded_many(space->scene->bvh, rays, used, true, occluded);
    for (uint32_t k = 0; k < used; k++) {
      if (occluded[k]) quality[who[k]] = 0;
    }
    used = 0;
  }
}

typedef struct view_counter {
  const olx_space *space;
  const olx_sight *sight;
  const olx_vec3 *places;
  const olx_surfels *surfels;
  uint8_t *views;
  uint32_t *first;
  uint32_t place_count, most;
} view_counter;

static bool may_see(const view_counter *c, olx_vec3 place, const olx_surfel *surfel) {
  if (c->sight) return olx_sight_quality(c->sight, place, surfel) != 0;
  return olx_dot(olx_sub(place, surfel->position), surfel->normal) > 0.0f;
}

// Counts the views of a batch of surfels, position by position until each surfel is seen often enough.
static void count_job(void *user, uint32_t index) {
  const view_counter *c = user;
  olx_ray rays[BATCH];
  uint32_t who[BATCH];
  uint8_t occluded[BATCH];
  const uint32_t first = index * BATCH, left = c->surfels->count - first, count = left < BATCH ? left : BATCH;
  memset(c->views + first, 0, count);
  for (uint32_t i = first; c->first && i < first + count; i++) c->first[i] = c->place_count;
  for (uint32_t p = 0; p < c->place_count; p++) {
    uint32_t used = 0;
    for (uint32_t i = first; i < first + count; i++) {
      if (c->views[i] >= c->most || !may_see(c, c->places[p], &c->surfels->items[i])) continue;
      rays[used] = ray_between(c->places[p], &c->surfels->items[i]);
      who[used++] = i;
    }
    olx_bvh_occluded_many(c->space->scene->bvh, rays, used, true, occluded);
    for (uint32_t k = 0; k < used; k++) {
      if (occluded[k]) continue;
      if (c->first && c->views[who[k]] == 0) c->first[who[k]] = p;
      c->views[who[k]]++;
    }
  }
}

olx_result olx_count_views(const olx_space *space, const olx_sight *sight, const olx_vec3 *places, uint32_t count,
                           const olx_surfels *surfels, uint32_t most, uint32_t threads, uint8_t *views,
                           uint32_t *first) {
  view_counter c = {space, sight, places, surfels, views, first, count, most};
  return olx_parallel_for((surfels->count + BATCH - 1) / BATCH, threads, count_job, &c, NULL, 0);
}
