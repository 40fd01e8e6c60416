// Divides the surfaces that probes and rays meet into cells and chooses a surfel in each: cells are halved until they are
// small beside the distance to what they see, or no larger than the points that found them are apart.
#include "light/light_surfels.h"

#include "core/hooks.h"
#include "core/result.h"
#include "core/sampling.h"

#include <stdlib.h>

enum { EXPLORING_RAYS = 32, CELLS_PER_JOB = 16, SALT_EXPLORE = 0x4558504C };

// Cells are not divided below this many footprints of the points in them.
static const float LEAST_FOOTPRINTS = 2.0f;
// Cells with fewer points than this are not divided: surfaces that so few rays meet send little light.
enum { LEAST_POINTS = 8 };
// Cells begin at this many halvings of the largest.
enum { FIRST_LEVEL = OLX_CELL_LEVELS - 3 };

olx_surface_point olx_surface_point_make(const olx_cell_grid *grid, const olx_surface *surface, const olx_ray_hit *hit,
                                         float footprint) {
  return (olx_surface_point){.key = olx_cell_key(grid, surface->position, surface->geometric_normal),
                             .triangle = hit->triangle,
                             .u = hit->u,
                             .v = hit->v,
                             .footprint = footprint,
                             .back_face = surface->back_face};
}

static olx_vec3 corner(const olx_scene *scene, uint32_t triangle, uint32_t i) {
  return scene->positions[scene->indices[3 * (size_t)triangle + i]];
}

olx_surface olx_surface_point_surface(const olx_scene *scene, const olx_surface_point *p) {
  const olx_vec3 a = corner(scene, p->triangle, 0), b = corner(scene, p->triangle, 1),
                 c = corner(scene, p->triangle, 2);
  const olx_vec3 outward = olx_normalize(olx_cross(olx_sub(b, a), olx_sub(c, a)));
  const olx_ray_hit hit = {.triangle = p->triangle, .u = p->u, .v = p->v};
  olx_surface surface = olx_surface_at(scene, &hit, p->back_face ? outward : olx_negate(outward));
  surface.shading_normal = olx_surface_vertex_normal(scene, &hit, &surface);
  return surface;
}

static olx_vec3 position_of(const olx_scene *scene, const olx_surface_point *p) {
  const olx_vec3 a = corner(scene, p->triangle, 0), b = corner(scene, p->triangle, 1),
                 c = corner(scene, p->triangle, 2);
  return olx_madd(olx_madd(olx_scale(a, 1.0f - p->u - p->v), b, p->u), c, p->v);
}

olx_result olx_light_surfels_create(olx_light_surfels *s, const olx_scene *scene, float spacing, uint32_t seed,
                                    uint32_t threads) {
  *s = (olx_light_surfels){.scene = scene,
                           .grid = olx_cell_grid_make(scene->bounds_min, scene->bounds_max),
                           .seed = seed,
                           .spacing = spacing,
                           .threads = threads};
  return olx_cell_table_create(&s->table, 1024);
}

void olx_light_surfels_free(olx_light_surfels *s) {
  olx_release(s->points);
  olx_release(s->surfels);
  olx_cell_table_free(&s->table);
  *s = (olx_light_surfels){0};
}

olx_surfel_found olx_light_surfels_find(const olx_light_surfels *s, uint64_t finest_key) {
  olx_surfel_found found = {.surfel = OLX_CELL_NONE};
  for (uint32_t level = FIRST_LEVEL + 1; level-- > 0;) {
    const uint32_t value = olx_cell_table_get(&s->table, olx_cell_at_level(finest_key, level));
    if (value == OLX_CELL_NONE) break;
    found.surfel = value & ~OLX_CELL_DIVIDED;
    found.side = value & OLX_CELL_DIVIDED ? olx_cell_side(&s->grid, level) : 0.0f;
  }
  return found;
}

// A cell that is to be divided or to get a surfel, and what is found out about it.
typedef struct cell_work {
  uint32_t first, end, level; // points of the batch
  uint32_t chosen;            // point for the surfel
  float nearest;
  bool divide;
} cell_work;

typedef struct cell_round {
  olx_light_surfels *surfels;
  const olx_surface_point *points;
  cell_work *cells;
  uint32_t count;
} cell_round;

// The point nearest to the middle of the cell's points, so that surfels of neighbouring cells are evenly spaced.
static uint32_t choose_point(const cell_round *r, const cell_work *cell) {
  const olx_scene *scene = r->surfels->scene;
  const olx_vec3 middle = olx_cell_middle(&r->surfels->grid, position_of(scene, &r->points[cell->first]), cell->level);
  uint32_t best = cell->first;
  float least = INFINITY;
  for (uint32_t i = cell->first; i < cell->end; i++) {
    const olx_vec3 way = olx_sub(position_of(scene, &r->points[i]), middle);
    const float distance = olx_dot(way, way);
    if (distance < least) {
      least = distance;
      best = i;
    }
  }
  return best;
}

static float least_footprint(const cell_round *r, const cell_work *cell) {
  float least = INFINITY;
  for (uint32_t i = cell->first; i < cell->end; i++) least = olx_min(least, r->points[i].footprint);
  return least;
}

// Harmonic mean distance of what a surface sees, and the least distance.
static float explore(const olx_light_surfels *s, const olx_surface *surface, uint64_t cell, float *nearest) {
  olx_ray rays[EXPLORING_RAYS];
  olx_ray_hit hits[EXPLORING_RAYS];
  const uint32_t seed = olx_hash3((uint32_t)cell, (uint32_t)(cell >> 32), SALT_EXPLORE);
  for (uint32_t i = 0; i < EXPLORING_RAYS; i++) {
    const olx_vec3 local = olx_sample_cosine(olx_stratified2(i, seed));
    rays[i] = olx_surface_ray(surface, olx_from_basis(local, surface->geometric_normal), INFINITY);
  }
  olx_bvh_intersect_many(s->scene->bvh, rays, EXPLORING_RAYS, false, hits);
  float inverse_sum = 0.0f;
  *nearest = INFINITY;
  for (uint32_t i = 0; i < EXPLORING_RAYS; i++) {
    if (hits[i].triangle == OLX_NO_HIT) continue;
    inverse_sum += 1.0f / olx_max(hits[i].t, s->grid.finest);
    *nearest = olx_min(*nearest, hits[i].t);
  }
  return inverse_sum > 0.0f ? EXPLORING_RAYS / inverse_sum : INFINITY;
}

static void examine_cell(const cell_round *r, cell_work *cell) {
  const olx_light_surfels *s = r->surfels;
  cell->chosen = choose_point(r, cell);
  const float side = olx_cell_side(&s->grid, cell->level);
  const olx_surface surface = olx_surface_point_surface(s->scene, &r->points[cell->chosen]);
  const uint64_t key = olx_cell_at_level(r->points[cell->chosen].key, cell->level);
  const float mean = explore(s, &surface, key, &cell->nearest);
  const bool small = cell->level == 0 || cell->end - cell->first < LEAST_POINTS ||
                     0.5f * side < LEAST_FOOTPRINTS * least_footprint(r, cell);
  cell->divide = !small && side > s->spacing * mean;
}

static void examine_cells(void *user, uint32_t job) {
  cell_round *r = user;
  const uint32_t end = (job + 1) * CELLS_PER_JOB < r->count ? (job + 1) * CELLS_PER_JOB : r->count;
  for (uint32_t i = job * CELLS_PER_JOB; i < end; i++) examine_cell(r, &r->cells[i]);
}

// The end of the points from `first` on that lie in one cell of `level`.
static uint32_t end_of_cell(const olx_surface_point *points, uint32_t first, uint32_t end, uint32_t level) {
  const uint64_t key = olx_cell_at_level(points[first].key, level);
  uint32_t low = first + 1, high = end;
  while (low < high) {
    const uint32_t middle = low + (high - low) / 2;
    if (olx_cell_at_level(points[middle].key, level) == key) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  return low;
}

// The cells of `level` that points from `first` to `end` lie in; returns their count.
static uint32_t split(const olx_surface_point *points, uint32_t first, uint32_t end, uint32_t level, cell_work *cells) {
  uint32_t count = 0;
  while (first < end) {
    const uint32_t next = end_of_cell(points, first, end, level);
    cells[count++] = (cell_work){.first = first, .end = next, .level = level};
    first = next;
  }
  return count;
}

static olx_result append_surfel(olx_light_surfels *s, const cell_round *r, const cell_work *cell, uint32_t base) {
  if (s->count == s->capacity) {
    const uint32_t capacity = s->capacity ? 2 * s->capacity : 4096;
    olx_light_surfel *larger = olx_allocate(capacity, sizeof *larger);
    if (!larger) return olx_fail(OLX_ERROR_MEMORY, "light: out of memory for %u surfels", capacity);
    for (uint32_t i = 0; i < s->count; i++) larger[i] = s->surfels[i];
    olx_release(s->surfels);
    s->surfels = larger;
    s->capacity = capacity;
  }
  const olx_surface_point *point = &r->points[cell->chosen];
  const olx_surface surface = olx_surface_point_surface(s->scene, point);
  s->surfels[s->count++] = (olx_light_surfel){.cell = olx_cell_at_level(point->key, cell->level),
                                              .point = *point,
                                              .position = surface.position,
                                              .normal = surface.geometric_normal,
                                              .side = olx_cell_side(&s->grid, cell->level),
                                              .nearest = cell->nearest,
                                              .first_point = base + cell->first,
                                              .point_count = cell->end - cell->first};
  return OLX_OK;
}

// Lets a new surfel stand for the divided cells around it that have none yet.
static olx_result stand_for_divided(olx_light_surfels *s, uint32_t surfel, uint32_t level) {
  const uint64_t finest = s->surfels[surfel].point.key;
  while (++level <= FIRST_LEVEL) {
    const uint64_t key = olx_cell_at_level(finest, level);
    if (olx_cell_table_get(&s->table, key) != OLX_CELL_NONE) break;
    OLX_TRY(olx_cell_table_set(&s->table, key, surfel | OLX_CELL_DIVIDED));
  }
  return OLX_OK;
}

// What was examined becomes surfels, or smaller cells in `next`; returns how many of these.
static olx_result settle_round(cell_round *r, uint32_t base, cell_work *next, uint32_t *next_count) {
  olx_light_surfels *s = r->surfels;
  *next_count = 0;
  for (uint32_t i = 0; i < r->count; i++) {
    const cell_work *cell = &r->cells[i];
    const uint64_t key = olx_cell_at_level(r->points[cell->first].key, cell->level);
    if (cell->divide) {
      *next_count += split(r->points, cell->first, cell->end, cell->level - 1, next + *next_count);
      continue;
    }
    OLX_TRY(olx_cell_table_set(&s->table, key, s->count));
    OLX_TRY(append_surfel(s, r, cell, base));
    OLX_TRY(stand_for_divided(s, s->count - 1, cell->level));
  }
  return OLX_OK;
}

static olx_result divide_cells(olx_light_surfels *s, const olx_surface_point *points, uint32_t count, uint32_t base,
                               cell_work *cells, cell_work *next) {
  cell_round r = {.surfels = s, .points = points, .cells = cells};
  r.count = split(points, 0, count, FIRST_LEVEL, cells);
  while (r.count > 0) {
    const uint32_t jobs = (r.count + CELLS_PER_JOB - 1) / CELLS_PER_JOB;
    OLX_TRY(olx_parallel_for(jobs, s->threads, examine_cells, &r, s->task, 0));
    s->rays += (uint64_t)r.count * EXPLORING_RAYS;
    uint32_t next_count;
    OLX_TRY(settle_round(&r, base, next, &next_count));
    cell_work *const swap = r.cells;
    r.cells = next;
    next = swap;
    r.count = next_count;
  }
  return OLX_OK;
}

static int by_key(const void *a, const void *b) {
  const olx_surface_point *p = a, *q = b;
  if (p->key != q->key) return p->key < q->key ? -1 : 1;
  if (p->triangle != q->triangle) return p->triangle < q->triangle ? -1 : 1;
  if (p->u != q->u) return p->u < q->u ? -1 : 1;
  return p->v < q->v ? -1 : p->v > q->v;
}

// Appends the points, sorted by key.
static olx_result keep_points(olx_light_surfels *s, const olx_surface_point *points, uint32_t count) {
  olx_surface_point *all = olx_allocate((size_t)s->point_count + count, sizeof *all);
  if (!all) return olx_fail(OLX_ERROR_MEMORY, "light: out of memory for %u points of surfaces", count);
  for (uint32_t i = 0; i < s->point_count; i++) all[i] = s->points[i];
  for (uint32_t i = 0; i < count; i++) all[s->point_count + i] = points[i];
  qsort(all + s->point_count, count, sizeof *all, by_key);
  olx_release(s->points);
  s->points = all;
  s->point_count += count;
  return OLX_OK;
}

olx_result olx_light_surfels_add(olx_light_surfels *s, const olx_surface_point *points, uint32_t count) {
  const uint32_t base = s->point_count;
  OLX_TRY(keep_points(s, points, count));
  cell_work *cells = olx_allocate(count, sizeof *cells), *next = olx_allocate(count, sizeof *next);
  const olx_result result = cells && next
                                ? divide_cells(s, s->points + base, count, base, cells, next)
                                : olx_fail(OLX_ERROR_MEMORY, "light: out of memory for cells of %u points", count);
  olx_release(cells);
  olx_release(next);
  return result;
}
