// Covers worlds of many tiles tile by tile, each given the probes that the tiles around it already have.
#include "place/cover/tiles.h"

#include "core/hooks.h"
#include "core/result.h"
#include "core/sampling.h"
#include "place/space/space_find.h"

#include <string.h>

#define THINNED_COVERAGE 0.999f
enum { LEAST_CANDIDATES = 64, LEAST_SURFELS = 256 };

static olx_result no_memory(void) { return olx_fail(OLX_ERROR_MEMORY, "place: no memory for the probes of tiles"); }

olx_result olx_tiling_create(olx_world *world, const olx_sight *sight, const olx_place_settings *settings,
                             olx_tiling *t) {
  const olx_probe_rules *rules = &world->scene->probe_rules;
  *t = (olx_tiling){.world = world, .sight = sight, .settings = settings};
  t->tiles = olx_allocate_zero(world->tile_total, sizeof *t->tiles);
  t->pinned.items = olx_allocate(rules->pinned_count, sizeof *t->pinned.items);
  if (!t->tiles || !t->pinned.items) {
    olx_tiling_free(t);
    return no_memory();
  }
  for (; t->pinned.count < rules->pinned_count; t->pinned.count++) {
    t->pinned.items[t->pinned.count] = (olx_candidate){rules->pinned[t->pinned.count], OLX_ORIGIN_PINNED};
  }
  return OLX_OK;
}

void olx_tiling_free(olx_tiling *t) {
  for (uint32_t i = 0; t->tiles && i < t->world->tile_total; i++) olx_release(t->tiles[i].items);
  olx_release(t->tiles);
  olx_release(t->pinned.items);
  *t = (olx_tiling){0};
}

uint32_t olx_tile_colour(const olx_world *world, uint32_t tile) {
  const olx_tile at = olx_world_tile(world, tile, 0);
  uint32_t colour = 0;
  for (int axis = 0; axis < 3; axis++) {
    const uint32_t odd = (uint32_t)(world->first_tile[axis] + (int32_t)at.cell[axis]) & 1u;
    colour |= odd << axis;
  }
  return colour;
}

// Lists the neighbours of a tile.
static uint32_t tiles_around(const olx_world *w, uint32_t tile, uint32_t around[26]) {
  const olx_tile at = olx_world_tile(w, tile, 0);
  uint32_t count = 0;
  for (int32_t i = 0; i < 27; i++) {
    const int32_t step[3] = {i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1};
    uint32_t c[3];
    bool within = i != 13;
    for (int axis = 0; axis < 3; axis++) {
      c[axis] = at.cell[axis] + (uint32_t)step[axis];
      within = within && c[axis] < w->tiles[axis];
    }
    if (within) around[count++] = c[0] + w->tiles[0] * (c[1] + w->tiles[1] * c[2]);
  }
  return count;
}

static void append(olx_tile_probes *list, const olx_tile_probes *more) {
  if (more->count) memcpy(list->items + list->count, more->items, more->count * sizeof *more->items);
  list->count += more->count;
}

// Lists the pinned probes and those of neighbouring tiles.
static olx_result list_fixed(const olx_tiling *t, uint32_t tile, olx_tile_probes *fixed) {
  uint32_t around[26];
  const uint32_t count = tiles_around(t->world, tile, around);
  size_t most = t->pinned.count;
  for (uint32_t i = 0; i < count; i++) most += t->tiles[around[i]].count;
  *fixed = (olx_tile_probes){.items = olx_allocate(most, sizeof *fixed->items)};
  if (!fixed->items) return no_memory();
  append(fixed, &t->pinned);
  for (uint32_t i = 0; i < count; i++) append(fixed, &t->tiles[around[i]]);
  return OLX_OK;
}

// Counts the positions of the tile itself, without those around it.
static size_t count_core(const olx_space *space) {
  const olx_tile *tile = &space->tile;
  size_t count = 0;
  for (size_t i = 0; i < space->place_count; i++) {
    uint32_t c[3];
    bool within = true;
    olx_voxel_coordinates(&space->voxels, space->places[i], c);
    for (int axis = 0; axis < 3; axis++) {
      const uint32_t at = c[axis] + tile->from[axis];
      within = within && at >= tile->core_from[axis] && at < tile->core_to[axis];
    }
    count += within;
  }
  return count;
}

static uint32_t share_of(uint32_t wanted, size_t voxels, uint32_t least) {
  const double share = (double)wanted * (double)voxels / OLX_SETTINGS_VOXELS;
  const uint32_t floor_of = least < wanted ? least : wanted;
  return share < (double)floor_of ? floor_of : share > (double)wanted ? wanted : (uint32_t)share;
}

static olx_place_settings settings_of(const olx_tiling *t, const olx_space *space) {
  olx_place_settings s = *t->settings;
  uint32_t key = s.seed;
  for (int axis = 0; axis < 3; axis++) {
    key = olx_hash2(key, (uint32_t)(t->world->first_tile[axis] + (int32_t)space->tile.cell[axis]));
  }
  s.seed = key;
  s.candidates = share_of(s.candidates, space->place_count, LEAST_CANDIDATES);
  s.surfels = share_of(s.surfels, count_core(space), LEAST_SURFELS);
  // A requested number of probes is met by thinning out a cover of this coverage.
  if (s.count) s.coverage = olx_min(s.coverage, THINNED_COVERAGE);
  s.count = 0;
  return s;
}

static olx_result keep(olx_tile_probes *own, const olx_cover_result *found, uint32_t fixed) {
  own->items = olx_allocate(found->count - fixed, sizeof *own->items);
  if (!own->items) return no_memory();
  own->count = found->count - fixed;
  memcpy(own->items, found->probes + fixed, own->count * sizeof *own->items);
  return OLX_OK;
}

static olx_result cover_space(olx_tiling *t, const olx_space *space) {
  olx_tile_probes fixed;
  olx_cover_result found = {0};
  const olx_place_settings settings = settings_of(t, space);
  OLX_TRY(list_fixed(t, space->tile.index, &fixed));
  const olx_fixed_probes given = {fixed.items, fixed.count};
  olx_result result = olx_cover(space, t->sight, given, &settings, NULL, &found);
  if (result == OLX_OK) result = keep(&t->tiles[space->tile.index], &found, fixed.count);
  else if (result == OLX_ERROR_EMPTY) result = OLX_OK; // the tile has space without surfaces
  t->candidates += found.candidates;
  olx_release(found.probes);
  olx_release(fixed.items);
  return result;
}

olx_result olx_tiling_cover(olx_tiling *t, uint32_t tile) {
  olx_space space;
  OLX_TRY(olx_space_open(t->world, tile, OLX_TILE_OVERLAP, t->settings->threads, &space));
  const olx_result result = space.place_count > 0 ? cover_space(t, &space) : OLX_OK;
  olx_space_free(&space);
  return result;
}

olx_result olx_tiling_join(const olx_tiling *t, olx_candidate **probes, uint32_t *count) {
  size_t most = t->pinned.count;
  for (uint32_t i = 0; i < t->world->tile_total; i++) most += t->tiles[i].count;
  olx_tile_probes all = {.items = olx_allocate(most, sizeof *all.items)};
  if (!all.items) return no_memory();
  append(&all, &t->pinned);
  for (uint32_t i = 0; i < t->world->tile_total; i++) append(&all, &t->tiles[i]);
  *probes = all.items;
  *count = all.count;
  return OLX_OK;
}

// Covers all tiles, colour by colour.
olx_result olx_tiling_cover_all(olx_tiling *t, olx_task *task) {
  const uint64_t units = t->settings->candidates, total = t->world->tile_total;
  uint64_t done = 0;
  for (uint32_t colour = 0; colour < OLX_TILE_COLOURS; colour++) {
    for (uint32_t tile = 0; tile < total; tile++) {
      if (olx_tile_colour(t->world, tile) != colour) continue;
      OLX_TRY(olx_check_cancelled());
      OLX_TRY(olx_tiling_cover(t, tile));
      done++;
      olx_task_advance(task, units * done / total - units * (done - 1) / total);
    }
  }
  return OLX_OK;
}
