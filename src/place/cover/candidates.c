// Lists the positions that placement chooses from: voxels farthest from surfaces, points of the scene's grid, and
// positions spread evenly over the space that matters.
#include "place/cover/candidates.h"

#include "core/hooks.h"
#include "core/parallel.h"
#include "core/result.h"
#include "core/sampling.h"

#include <stdlib.h>
#include <string.h>

// Maxima closer to each other than this share of their distance to surfaces are merged.
#define SKELETON_SPACING 0.6f

typedef struct far_voxel {
  uint32_t distance; // squared
  size_t voxel;
} far_voxel;

static int compare_far(const void *a, const void *b) {
  const far_voxel *x = a, *y = b;
  if (x->distance != y->distance) return x->distance > y->distance ? -1 : 1;
  return x->voxel < y->voxel ? -1 : x->voxel > y->voxel;
}

// Returns whether no neighbour is farther from surfaces.
static bool is_maximum(const olx_voxels *v, size_t voxel) {
  uint32_t c[3];
  olx_voxel_coordinates(v, voxel, c);
  for (int i = 0; i < 3; i++) {
    if (c[i] == 0 || c[i] + 1 == v->count[i]) return false;
  }
  for (int32_t i = 0; i < 27; i++) {
    const int64_t step = i % 3 - 1 + (int64_t)v->count[0] * (i / 3 % 3 - 1 + (int64_t)v->count[1] * (i / 9 - 1));
    if (v->distance[(int64_t)voxel + step] > v->distance[voxel]) return false;
  }
  return true;
}

// Thins the maxima: takes the farthest from surfaces first, each at some distance from those taken before.
static uint32_t thin_out(const olx_voxels *v, const far_voxel *maxima, size_t maxima_count, uint32_t most,
                         olx_candidate *list) {
  uint32_t count = 0;
  for (size_t i = 0; i < maxima_count && count < most; i++) {
    const olx_vec3 place = olx_voxel_centre(v, maxima[i].voxel);
    const float spacing = SKELETON_SPACING * olx_voxel_distance(v, maxima[i].voxel);
    bool alone = true;
    for (uint32_t k = 0; k < count && alone; k++) alone = olx_length(olx_sub(place, list[k].place)) > spacing;
    if (alone) list[count++] = (olx_candidate){place, OLX_ORIGIN_SKELETON};
  }
  return count;
}

static olx_result add_skeleton(const olx_space *space, uint32_t most, olx_candidate *list, uint32_t *count) {
  const olx_voxels *v = &space->voxels;
  size_t found = 0, used = 0;
  for (size_t i = 0; i < space->place_count; i++) found += is_maximum(v, space->places[i]);
  far_voxel *maxima = olx_allocate(found, sizeof *maxima);
  if (!maxima) return olx_fail(OLX_ERROR_MEMORY, "place: out of memory");
  for (size_t i = 0; i < space->place_count; i++) {
    const size_t voxel = space->places[i];
    if (is_maximum(v, voxel)) maxima[used++] = (far_voxel){v->distance[voxel], voxel};
  }
  qsort(maxima, found, sizeof *maxima, compare_far);
  *count += thin_out(v, maxima, found, most, list + *count);
  olx_release(maxima);
  return OLX_OK;
}

static olx_vec3 grid_point(const olx_grid *grid, uint64_t i) {
  const olx_vec3 cell = {(float)(i % grid->count[0]), (float)(i / grid->count[0] % grid->count[1]),
                         (float)(i / grid->count[0] / grid->count[1])};
  return olx_add(grid->origin, olx_mul(cell, grid->spacing));
}

// Adds the points of a grid that the space allows, or `most` of them, evenly spread over their order.
static void add_grid(const olx_space *space, const olx_grid *grid, uint32_t most, olx_candidate *list,
                     uint32_t *count) {
  const uint64_t total = (uint64_t)grid->count[0] * grid->count[1] * grid->count[2];
  uint64_t allowed = 0, passed = 0;
  for (uint64_t i = 0; i < total; i++) allowed += olx_space_allows(space, grid_point(grid, i));
  const uint64_t wanted = allowed < most ? allowed : most;
  for (uint64_t i = 0; i < total; i++) {
    const olx_vec3 p = grid_point(grid, i);
    if (!olx_space_allows(space, p)) continue;
    const bool added = (passed + 1) * wanted / allowed > passed * wanted / allowed;
    if (added) list[(*count)++] = (olx_candidate){p, OLX_ORIGIN_GRID};
    passed++;
  }
}

// A division of space into cells of `edge` voxels along a side.
typedef struct cells {
  uint32_t edge, count[3];
  size_t total;
} cells;

static cells cut_cells(const olx_voxels *v, uint32_t edge) {
  cells c = {.edge = edge, .total = 1};
  for (int i = 0; i < 3; i++) {
    c.count[i] = (v->count[i] + edge - 1) / edge;
    c.total *= c.count[i];
  }
  return c;
}

static size_t cell_of(const olx_voxels *v, const cells *c, size_t voxel) {
  uint32_t xyz[3];
  olx_voxel_coordinates(v, voxel, xyz);
  return xyz[0] / c->edge + c->count[0] * (xyz[1] / c->edge + c->count[1] * (size_t)(xyz[2] / c->edge));
}

// Chooses one voxel in each cell that allows a probe: the one with the largest hash. Returns the number of such cells.
static size_t choose_in_cells(const olx_space *space, const cells *c, uint32_t seed, size_t *chosen) {
  size_t used = 0;
  for (size_t i = 0; i < c->total; i++) chosen[i] = OLX_NO_VOXEL;
  for (size_t i = 0; i < space->place_count; i++) {
    const size_t voxel = space->places[i];
    size_t *here = &chosen[cell_of(&space->voxels, c, voxel)];
    used += *here == OLX_NO_VOXEL;
    if (*here == OLX_NO_VOXEL || olx_hash2(seed, (uint32_t)voxel) > olx_hash2(seed, (uint32_t)*here)) *here = voxel;
  }
  return used;
}

static olx_result add_spread(const olx_space *space, uint32_t most, uint32_t seed, olx_candidate *list,
                             uint32_t *count) {
  size_t *chosen = olx_allocate(space->voxels.total, sizeof *chosen);
  if (!chosen) return olx_fail(OLX_ERROR_MEMORY, "place: out of memory");
  // Bisects for the smallest cells that are few enough: from one voxel per cell to all voxels in one cell.
  uint32_t low = 1, high = 1;
  for (int i = 0; i < 3; i++) high = space->voxels.count[i] > high ? space->voxels.count[i] : high;
  olx_result result = OLX_OK;
  while (low < high && result == OLX_OK) {
    const uint32_t middle = (low + high) / 2;
    const cells c = cut_cells(&space->voxels, middle);
    if (choose_in_cells(space, &c, seed, chosen) <= most) high = middle;
    else low = middle + 1;
    result = olx_check_cancelled();
  }
  const cells c = cut_cells(&space->voxels, low);
  const size_t used = choose_in_cells(space, &c, seed, chosen);
  for (size_t i = 0; i < c.total && used <= most; i++) {
    if (chosen[i] == OLX_NO_VOXEL) continue;
    list[(*count)++] = (olx_candidate){olx_voxel_centre(&space->voxels, chosen[i]), OLX_ORIGIN_SPACE};
  }
  olx_release(chosen);
  return result;
}

olx_result olx_candidates_create(const olx_space *space, const olx_grid *grid, uint32_t wanted, uint32_t seed,
                                 olx_candidate **candidates, uint32_t *count) {
  *count = 0;
  *candidates = olx_allocate(wanted, sizeof **candidates);
  if (!*candidates) return olx_fail(OLX_ERROR_MEMORY, "place: no memory for %u candidates", wanted);
  olx_result result;
  OLX_TRY_GOTO(add_skeleton(space, wanted / 3, *candidates, count), failed);
  add_grid(space, grid, wanted / 6, *candidates, count);
  OLX_TRY_GOTO(add_spread(space, wanted - *count, seed, *candidates, count), failed);
  return OLX_OK;
failed:
  olx_release(*candidates);
  *candidates = NULL;
  return result;
}
