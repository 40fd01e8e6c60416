// Builds bricks: divides space into cells, ranks the probes that see each cell's points, and stores each distinct list
// once; cells grow until the structure fits its budget of bytes.
#include "bake/selectors/bricks_build.h"

#include "bake/selectors/bricks_rank.h"
#include "core/hooks.h"
#include "core/result.h"
#include "core/sampling.h"
#include "field/coded_probes.h"

#include <stdlib.h>
#include <string.h>

enum {
  MOST_POINTS = 1 << 20,  // surface points that are sampled to locate surfaces
  MOST_DIVIDED = 1 << 10, // most bricks with cells of their own: bounds the build time
  MOST_BRICKS = 1 << 16,
  SURFACE_SAMPLES = 8,      // per cell
  SPACE_SAMPLES = 4,        // per cell
  BRICK_SPACE_SAMPLES = 32, // per brick without surfaces
  FINEST = 256              // initial number of cells along the longest side of space
};

// Factor by which the side of a cell grows until the structure fits its budget.
static const float COARSER = 1.15f;
static const float SPACE_WEIGHT = 0.5f;

// A point on a surface that some probe sees.
typedef struct point {
  olx_vec3 position, normal;
} point;

typedef struct sorted_point {
  uint64_t key; // brick, cell, and a random number
  uint32_t index;
} sorted_point;

typedef struct grid {
  olx_vec3 origin;
  float cell;       // metres
  uint32_t size[3]; // bricks
} grid;

typedef struct site {
  const olx_selector_input *input;
  olx_probe_views views;
  olx_vec3 min, max; // bounds of all that probes see
  point *points;
  uint32_t point_count;
  grid grid;
  sorted_point *sorted;
  uint32_t *first_point; // index of each brick's first point, and the end
  uint32_t *first_list;  // index of each brick's first list, and the end: OLX_BRICK_CELLS lists per brick with
                         // surfaces, otherwise one
  uint16_t (*lists)[OLX_BRICK_PROBES];
} site;

static olx_result out_of_memory(void) { return olx_fail(OLX_ERROR_MEMORY, "bake: out of memory for bricks"); }

// Turns every texel of the views into a surface point, thinned to MOST_POINTS.
static olx_result find_points(site *s) {
  const olx_selector_input *input = s->input;
  const uint64_t texels = (uint64_t)s->views.n * s->views.n, all = texels * input->count;
  const uint64_t stride = (all + MOST_POINTS - 1) / MOST_POINTS | 1u; // odd, so that every column of the maps is
                                                                      // sampled
  s->points = olx_allocate(all / stride + 1, sizeof *s->points);
  if (!s->points) return out_of_memory();
  s->min = s->max = input->positions[0];
  for (uint32_t i = 1; i < input->count; i++) {
    s->min = olx_min_each(s->min, input->positions[i]);
    s->max = olx_max_each(s->max, input->positions[i]);
  }
  for (uint64_t i = 0; i < all; i += stride) {
    const uint32_t probe = (uint32_t)(i / texels), texel = (uint32_t)(i % texels);
    const float distance = s->views.distance[i];
    if (distance == INFINITY || (input->flags[probe] & OLX_PROBE_BURIED)) continue;
    const olx_vec3 direction = olx_texel_direction(texel % s->views.n, texel / s->views.n, s->views.n);
    const olx_vec3 position = olx_madd(input->positions[probe], direction, distance);
    s->points[s->point_count++] = (point){position, olx_normal_unpack(s->views.normal[i])};
    s->min = olx_min_each(s->min, position);
    s->max = olx_max_each(s->max, position);
  }
  return OLX_OK;
}

static grid grid_of(const site *s, float cell) {
  const olx_vec3 extent = olx_sub(s->max, s->min);
  const float size[3] = {extent.x, extent.y, extent.z}, brick = cell * OLX_BRICK_SIDE;
  grid g = {.origin = s->min, .cell = cell};
  for (uint32_t axis = 0; axis < 3; axis++) {
    g.size[axis] = (uint32_t)olx_clamp(ceilf(size[axis] / brick), 1.0f, 65536.0f);
  }
  return g;
}

static uint64_t brick_count(const grid *g) { return (uint64_t)g->size[0] * g->size[1] * g->size[2]; }

// Returns the index of the cell that holds a position: OLX_BRICK_CELLS times the index of its brick, plus its index
// within the brick.
static uint64_t cell_of(const grid *g, olx_vec3 position) {
  const olx_vec3 offset = olx_sub(position, g->origin);
  const float along[3] = {offset.x, offset.y, offset.z}, per_metre = 1.0f / g->cell;
  uint64_t brick = 0;
  uint32_t cell = 0;
  for (uint32_t axis = 3; axis-- > 0;) {
    const uint32_t last = g->size[axis] * OLX_BRICK_SIDE - 1;
    const uint32_t i = (uint32_t)olx_clamp(along[axis] * per_metre, 0.0f, (float)last);
    brick = brick * g->size[axis] + i / OLX_BRICK_SIDE;
    cell = cell * OLX_BRICK_SIDE + i % OLX_BRICK_SIDE;
  }
  return brick * OLX_BRICK_CELLS + cell;
}

static uint64_t bytes_of(uint64_t bricks, uint64_t divided, uint64_t lists) {
  return sizeof(olx_bricks_header) + 4 * (bricks + divided * OLX_BRICK_CELL_WORDS + lists * OLX_BRICK_LIST_WORDS);
}

// Finds whether bricks of this size are likely to fit the budget, on the assumption that every third cell has a
// distinct list.
static olx_result may_fit(const site *s, const grid *g, bool *fits) {
  const uint64_t bricks = brick_count(g), budget = olx_bricks_budget(s->input->map_bytes);
  *fits = bricks <= MOST_BRICKS && bytes_of(bricks, 0, 1) <= budget;
  if (!*fits) return OLX_OK;
  uint8_t *seen = olx_allocate_zero(bricks, 1);
  if (!seen) return out_of_memory();
  uint64_t divided = 0;
  for (uint32_t i = 0; i < s->point_count; i++) {
    const uint64_t brick = cell_of(g, s->points[i].position) / OLX_BRICK_CELLS;
    divided += !seen[brick];
    seen[brick] = 1;
  }
  olx_release(seen);
  *fits = divided <= MOST_DIVIDED && bytes_of(bricks, divided, divided * OLX_BRICK_CELLS / 3) <= budget;
  return OLX_OK;
}

static int compare_points(const void *a, const void *b) {
  const sorted_point *x = a, *y = b;
  if (x->key != y->key) return x->key < y->key ? -1 : 1;
  return (x->index > y->index) - (x->index < y->index);
}

// Sorts points by brick and cell, at random within a cell, and counts the lists before each brick.
static olx_result sort_points(site *s) {
  const uint32_t bricks = (uint32_t)brick_count(&s->grid);
  s->sorted = olx_allocate(s->point_count, sizeof *s->sorted);
  s->first_point = olx_allocate((size_t)bricks + 1, sizeof *s->first_point);
  s->first_list = olx_allocate((size_t)bricks + 1, sizeof *s->first_list);
  if (!s->sorted || !s->first_point || !s->first_list) return out_of_memory();
  for (uint32_t i = 0; i < s->point_count; i++) {
    s->sorted[i] = (sorted_point){cell_of(&s->grid, s->points[i].position) << 32 | olx_hash(i), i};
  }
  qsort(s->sorted, s->point_count, sizeof *s->sorted, compare_points);
  uint32_t at = 0, list = 0;
  for (uint32_t brick = 0; brick < bricks; brick++) {
    s->first_point[brick] = at;
    s->first_list[brick] = list;
    while (at < s->point_count && (s->sorted[at].key >> 32) / OLX_BRICK_CELLS == brick) at++;
    list += at > s->first_point[brick] ? OLX_BRICK_CELLS : 1;
  }
  s->first_point[bricks] = at;
  s->first_list[bricks] = list;
  s->lists = olx_allocate(list, sizeof *s->lists);
  return s->lists ? OLX_OK : out_of_memory();
}

static void leave_site(site *s) {
  olx_release(s->sorted);
  olx_release(s->first_point);
  olx_release(s->first_list);
  olx_release(s->lists);
  s->sorted = NULL;
  s->first_point = s->first_list = NULL;
  s->lists = NULL;
}

// Adds sample points spread through a box of space.
static uint32_t add_space(olx_vec3 corner, float side, uint32_t wanted, uint32_t seed, olx_brick_sample *samples) {
  for (uint32_t i = 0; i < wanted; i++) {
    const olx_vec2 plane = olx_stratified2(i, seed);
    const float z = ((float)i + olx_unit_float(olx_hash2(seed, i))) / (float)wanted;
    samples[i] = (olx_brick_sample){olx_madd(corner, olx_v3(plane.x, plane.y, z), side), olx_splat(0.0f), SPACE_WEIGHT};
  }
  return wanted;
}

static bool is_empty(const uint16_t *list) { return list[0] == OLX_BRICK_NO_PROBE; }

// Ranks the probes for the cells of a brick. Cells that no probe sees inherit the brick's list.
static void rank_cells(const site *s, uint32_t brick, olx_vec3 corner, const uint32_t *candidates, uint32_t count,
                       const uint16_t *whole) {
  uint32_t at = s->first_point[brick];
  for (uint32_t cell = 0; cell < OLX_BRICK_CELLS; cell++) {
    olx_brick_sample samples[SURFACE_SAMPLES + SPACE_SAMPLES];
    const uint64_t key = (uint64_t)brick * OLX_BRICK_CELLS + cell;
    uint32_t sample_count = 0;
    for (; at < s->first_point[brick + 1] && s->sorted[at].key >> 32 == key; at++) {
      if (sample_count == SURFACE_SAMPLES) continue;
      const point *p = &s->points[s->sorted[at].index];
      samples[sample_count++] = (olx_brick_sample){p->position, p->normal, 1.0f};
    }
    const olx_vec3 place = olx_v3((float)(cell % OLX_BRICK_SIDE), (float)(cell / OLX_BRICK_SIDE % OLX_BRICK_SIDE),
                                  (float)(cell / OLX_BRICK_SIDE / OLX_BRICK_SIDE));
    sample_count += add_space(olx_madd(corner, place, s->grid.cell), s->grid.cell, SPACE_SAMPLES, (uint32_t)key,
                              samples + sample_count);
    uint16_t *list = s->lists[s->first_list[brick] + cell];
    olx_brick_rank(&s->views, candidates, count, samples, sample_count, list);
    if (is_empty(list)) memcpy(list, whole, sizeof s->lists[0]);
  }
}

static void rank_brick(void *user, uint32_t brick) {
  const site *s = user;
  const float side = s->grid.cell * OLX_BRICK_SIDE;
  const olx_vec3 place = olx_v3((float)(brick % s->grid.size[0]), (float)(brick / s->grid.size[0] % s->grid.size[1]),
                                (float)(brick / s->grid.size[0] / s->grid.size[1]));
  const olx_vec3 corner = olx_madd(s->grid.origin, place, side);
  uint32_t candidates[OLX_BRICK_CANDIDATES];
  const uint32_t count = olx_brick_candidates(s->input, olx_madd(corner, olx_splat(0.5f), side), candidates);
  olx_brick_sample samples[BRICK_SPACE_SAMPLES];
  add_space(corner, side, BRICK_SPACE_SAMPLES, olx_hash(brick), samples);
  uint16_t whole[OLX_BRICK_PROBES];
  olx_brick_rank(&s->views, candidates, count, samples, BRICK_SPACE_SAMPLES, whole);
  if (s->first_list[brick + 1] - s->first_list[brick] == 1) {
    memcpy(s->lists[s->first_list[brick]], whole, sizeof whole);
  } else {
    rank_cells(s, brick, corner, candidates, count, whole);
  }
}

// The distinct lists, in a hash table.
typedef struct palette {
  uint16_t (*lists)[OLX_BRICK_PROBES];
  uint32_t count, limit;
  uint32_t *slots; // 1 + index of the list, 0 where there is none
  uint32_t slot_mask;
} palette;

// Returns the index of a list, which is added when it is new; `limit` when there is no room.
static uint32_t number_of(palette *p, const uint16_t *list) {
  uint32_t hash = 0;
  for (uint32_t i = 0; i < OLX_BRICK_PROBES; i++) hash = olx_hash2(hash, list[i]);
  for (uint32_t slot = hash & p->slot_mask;; slot = (slot + 1) & p->slot_mask) {
    if (p->slots[slot] == 0) {
      if (p->count == p->limit) return p->limit;
      memcpy(p->lists[p->count++], list, sizeof p->lists[0]);
      p->slots[slot] = p->count;
      return p->count - 1;
    }
    if (memcmp(p->lists[p->slots[slot] - 1], list, sizeof p->lists[0]) == 0) return p->slots[slot] - 1;
  }
}

static bool is_uniform(const site *s, uint32_t brick) {
  for (uint32_t i = s->first_list[brick] + 1; i < s->first_list[brick + 1]; i++) {
    if (memcmp(s->lists[i], s->lists[i - 1], sizeof s->lists[0]) != 0) return false;
  }
  return true;
}

// Assigns an index to every list. Returns false when there are too many distinct ones.
static bool number_lists(const site *s, palette *p, uint32_t *numbers) {
  const uint32_t count = s->first_list[brick_count(&s->grid)];
  for (uint32_t i = 0; i < count; i++) {
    numbers[i] = number_of(p, s->lists[i]);
    if (numbers[i] == p->limit) return false;
  }
  return true;
}

static olx_result write_bricks(const site *s, const palette *p, const uint32_t *numbers, void **data, size_t *size) {
  const uint32_t bricks = (uint32_t)brick_count(&s->grid);
  uint32_t divided = 0;
  for (uint32_t i = 0; i < bricks; i++) divided += !is_uniform(s, i);
  const uint64_t bytes = bytes_of(bricks, divided, p->count);
  *data = NULL;
  *size = 0;
  if (bytes > olx_bricks_budget(s->input->map_bytes)) return OLX_OK;
  olx_bricks_header *header = olx_allocate_zero(bytes, 1);
  if (!header) return out_of_memory();
  *header = (olx_bricks_header){.origin = {s->grid.origin.x, s->grid.origin.y, s->grid.origin.z},
                                .cell_metres = s->grid.cell,
                                .size = {s->grid.size[0], s->grid.size[1], s->grid.size[2]},
                                .divided = divided,
                                .lists = p->count};
  uint32_t *index = (uint32_t *)(header + 1), *cells = index + bricks;
  uint32_t *lists = cells + (size_t)divided * OLX_BRICK_CELL_WORDS, next = 0;
  for (uint32_t i = 0; i < bricks; i++) {
    const uint32_t *of = numbers + s->first_list[i];
    index[i] = is_uniform(s, i) ? of[0] : OLX_BRICK_DIVIDED | next++;
    if (!(index[i] & OLX_BRICK_DIVIDED)) continue;
    for (uint32_t c = 0; c < OLX_BRICK_CELLS; c += 2) *cells++ = of[c] | of[c + 1] << 16;
  }
  for (uint32_t i = 0; i < p->count; i++) {
    for (uint32_t k = 0; k < OLX_BRICK_PROBES; k += 2) *lists++ = p->lists[i][k] | (uint32_t)p->lists[i][k + 1] << 16;
  }
  *data = header;
  *size = bytes;
  return OLX_OK;
}

// Packs the structure as the file stores it; NULL when it takes more than the budget.
static olx_result pack(const site *s, void **data, size_t *size) {
  enum { SLOTS = OLX_BRICK_MOST_LISTS * 2 };
  palette p = {.lists = olx_allocate(OLX_BRICK_MOST_LISTS, sizeof *p.lists),
               .limit = OLX_BRICK_MOST_LISTS,
               .slots = olx_allocate_zero(SLOTS, sizeof *p.slots),
               .slot_mask = SLOTS - 1};
  uint32_t *numbers = olx_allocate(s->first_list[brick_count(&s->grid)], sizeof *numbers);
  olx_result result = OLX_OK;
  if (!p.lists || !p.slots || !numbers) {
    result = out_of_memory();
  } else if (number_lists(s, &p, numbers)) {
    result = write_bricks(s, &p, numbers, data, size);
  }
  olx_release(p.lists);
  olx_release(p.slots);
  olx_release(numbers);
  return result;
}

// Builds the structure with cells of one size.
static olx_result build_at(site *s, float cell, void **data, size_t *size) {
  bool fits;
  s->grid = grid_of(s, cell);
  OLX_TRY(may_fit(s, &s->grid, &fits));
  if (!fits && brick_count(&s->grid) > 1) return OLX_OK;
  olx_result result;
  OLX_TRY_GOTO(sort_points(s), done);
  OLX_TRY_GOTO(olx_parallel_for((uint32_t)brick_count(&s->grid), s->input->threads, rank_brick, s, s->input->task, 0),
               done);
  OLX_TRY_GOTO(pack(s, data, size), done);
done:
  leave_site(s);
  return result;
}

static olx_result build(site *s, void **data, size_t *size) {
  OLX_TRY(olx_probe_views_create(s->input, &s->views));
  OLX_TRY(find_points(s));
  const float longest = olx_max3(olx_sub(s->max, s->min));
  float cell = longest > 0.0f ? longest / FINEST : 1.0f;
  while (!*data) {
    OLX_TRY(build_at(s, cell, data, size));
    cell *= COARSER;
  }
  return OLX_OK;
}

olx_result olx_bricks_build(const olx_selector_input *input, void **data, size_t *size_bytes) {
  _Static_assert(OLX_MAX_CODED_PROBES <= OLX_BRICK_NO_PROBE, "the number that stands for no probe names one");
  if (input->count > OLX_MAX_CODED_PROBES) {
    return olx_fail(OLX_ERROR_ARGUMENT, "bake: bricks list at most %d probes", OLX_MAX_CODED_PROBES);
  }
  *data = NULL;
  site s = {.input = input};
  const olx_result result = build(&s, data, size_bytes);
  olx_release(s.points);
  olx_probe_views_free(&s.views);
  return result;
}
