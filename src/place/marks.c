// Collects what an image of a placement shows besides its probes: surfels that stay uncovered, and the skeleton of free
// space.
#include "place/marks.h"

#include "core/hooks.h"
#include "core/result.h"

#include <string.h>

enum {
  MOST_MARKS = 8192,        // most marks of surfels, and of the skeleton
  MOST_TILED_MARKS = 65536, // most marks of surfels of all tiles, shared evenly between them
  LEAST_TILE_MARKS = 16     // most marks of a tile where its share would be smaller
};

static olx_result make_room(olx_probe_set *set, uint32_t more) {
  olx_place_mark *marks = olx_allocate((size_t)set->mark_count + more, sizeof *marks);
  if (!marks) return olx_fail(OLX_ERROR_MEMORY, "place: no memory for %u marks", more);
  if (set->mark_count) memcpy(marks, set->marks, set->mark_count * sizeof *marks);
  olx_release(set->marks);
  set->marks = marks;
  return OLX_OK;
}

// Returns the number of marks for `count` things: they are thinned evenly to at most MOST_MARKS.
static uint32_t kept_of(uint32_t count) { return count < MOST_MARKS ? count : MOST_MARKS; }

static uint32_t kept_of_tile(uint32_t count, uint32_t tiles) {
  if (tiles == 1) return kept_of(count);
  const uint32_t most = MOST_TILED_MARKS / tiles > LEAST_TILE_MARKS ? MOST_TILED_MARKS / tiles : LEAST_TILE_MARKS;
  return count < most ? count : most;
}

olx_result olx_mark_unreached(const olx_surfels *area, uint32_t tiles, olx_probe_set *set) {
  const uint32_t kept = kept_of_tile(area->cut_off_count, tiles);
  OLX_TRY(make_room(set, kept));
  for (uint64_t i = 0; i < kept; i++) {
    const olx_vec3 place = area->cut_off[i * area->cut_off_count / kept];
    set->marks[set->mark_count++] = (olx_place_mark){.position = place, .kind = OLX_MARK_UNREACHED};
  }
  return OLX_OK;
}

olx_result olx_mark_uncovered(const olx_surfels *surfels, const uint8_t *views, uint32_t tiles, olx_probe_set *set) {
  uint32_t lacking = 0, nth = 0, taken = 0;
  for (uint32_t i = 0; i < surfels->count; i++) lacking += views[i] < set->settings.views;
  const uint32_t kept = kept_of_tile(lacking, tiles);
  OLX_TRY(make_room(set, kept));
  for (uint32_t i = 0; i < surfels->count && taken < kept; i++) {
    if (views[i] >= set->settings.views || (uint64_t)nth++ * kept / lacking < taken) continue;
    const olx_surfel *surfel = &surfels->items[i];
    const bool missed = surfel->fate == OLX_SURFEL_FIT;
    set->marks[set->mark_count++] =
        (olx_place_mark){.position = surfel->position, .kind = missed ? OLX_MARK_MISSED : OLX_MARK_HOPELESS};
    taken++;
  }
  return OLX_OK;
}

static void add_skeleton(olx_probe_set *set, olx_vec3 place, float radius) {
  set->marks[set->mark_count++] =
      (olx_place_mark){.position = place, .radius = isfinite(radius) ? radius : 0.0f, .kind = OLX_MARK_SKELETON};
}

static olx_result mark_balls(const olx_space *space, const olx_sight *sight, olx_probe_set *set) {
  olx_medial_ball *balls = NULL;
  uint32_t count = 0;
  olx_result result = olx_area_balls(space, sight, &set->settings, &balls, &count);
  if (result == OLX_OK) result = make_room(set, kept_of(count));
  for (uint64_t i = 0; result == OLX_OK && i < kept_of(count); i++) {
    const olx_medial_ball *ball = &balls[i * count / kept_of(count)];
    if (olx_space_reaches(space, ball->centre)) add_skeleton(set, ball->centre, ball->radius);
  }
  olx_release(balls);
  return result;
}

static olx_result mark_far_voxels(const olx_space *space, olx_probe_set *set) {
  olx_cluster_item *items;
  uint32_t count;
  OLX_TRY(olx_far_voxels(space, &items, &count));
  const olx_result result = make_room(set, kept_of(count));
  for (uint64_t i = 0; result == OLX_OK && i < kept_of(count); i++) {
    const olx_vec3 place = items[i * count / kept_of(count)].place;
    add_skeleton(set, place, olx_voxel_distance(&space->voxels, olx_voxel_at(&space->voxels, place)));
  }
  olx_release(items);
  return result;
}

olx_result olx_mark_skeleton(const olx_space *space, const olx_sight *sight, olx_probe_set *set) {
  return set->settings.method == OLX_PLACE_MEDIAL ? mark_balls(space, sight, set) : mark_far_voxels(space, set);
}
