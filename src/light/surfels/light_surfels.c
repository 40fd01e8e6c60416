// Divides the surfaces that probes and rays hit into cells, halved until they are small relative to the distance to
// what they see, or to the spacing of their points. Points of a cell that see each other share a surfel.
#include "light/surfels/light_surfels.h"

#include "core/hooks.h"
#include "core/result.h"
#include "core/sampling.h"
#include "scene/bvh.h"

#include <stdlib.h>

enum { EXPLORED_POINTS = 4, EXPLORING_RAYS = 32, CELLS_PER_JOB = 16, SALT_EXPLORE = 0x4558504C };

// Cells are not divided below this many footprints of their points.
static const float LEAST_FOOTPRINTS = 2.0f;
// Cells with fewer points than this are not divided, because surfaces that so few rays hit reflect little light. The
// second bound is for hidden surfaces, which rays hit and no probe sees.
enum { LEAST_POINTS = 8, LEAST_HIDDEN_POINTS = 64 };
// The number of points of a cell that are tested before all of them are, and the most surfels that a cell gets at a
// time.
enum { TRIED_POINTS = 16, MOST_GROUPS = 4 };
// Within this share of the distance to the nearest surface that a surfel sees, no point is assumed to be occluded from
// it, unless the point lies behind its plane by more than the second share of the distance between them, where it may
// be on the far side of a thin pane.
static const float CLEAR_SHARE = 0.7f, BEHIND_SHARE = 0.01f;
// Offset above the surface of rays between surfels and points: this share of their length plus this share of the
// world's extent.
static const float LIFT_OF_DISTANCE = 0.03f, LIFT_OF_WORLD = 0x1p-21f;
// The level of the initial cells: two halvings below the largest.
enum { FIRST_LEVEL = OLX_CELL_LEVELS - 3 };

olx_surfel_point olx_surfel_point_make(const olx_cell_grid *grid, const olx_surface *surface, const olx_ray_hit *hit,
                                       float footprint) {
  return (olx_surfel_point){.key = olx_cell_key(grid, surface->position, surface->geometric_normal),
                            .triangle = hit->triangle,
                            .u = hit->u,
                            .v = hit->v,
                            .footprint = footprint,
                            .back_face = surface->back_face};
}

olx_surface olx_surfel_point_surface(const olx_scene *scene, const olx_surfel_point *p) {
  const olx_vec3 a = olx_scene_corner(scene, p->triangle, 0), b = olx_scene_corner(scene, p->triangle, 1),
                 c = olx_scene_corner(scene, p->triangle, 2);
  const olx_vec3 outward = olx_normalize(olx_cross(olx_sub(b, a), olx_sub(c, a)));
  const olx_ray_hit hit = {.triangle = p->triangle, .u = p->u, .v = p->v};
  olx_surface surface = olx_surface_at(scene, &hit, p->back_face ? outward : olx_negate(outward));
  surface.shading_normal = olx_surface_vertex_normal(scene, &hit, &surface);
  return surface;
}

static olx_vec3 position_of(const olx_scene *scene, const olx_surfel_point *p) {
  const olx_vec3 a = olx_scene_corner(scene, p->triangle, 0), b = olx_scene_corner(scene, p->triangle, 1),
                 c = olx_scene_corner(scene, p->triangle, 2);
  return olx_madd(olx_madd(olx_scale(a, 1.0f - p->u - p->v), b, p->u), c, p->v);
}

olx_result olx_light_surfels_create(olx_light_surfels *s, const olx_scene *scene, float spacing, uint32_t seed,
                                    uint32_t threads) {
  *s = (olx_light_surfels){.scene = scene,
                           .grid = olx_cell_grid_make(scene->bounds_min, scene->bounds_max),
                           .seed = seed,
                           .spacing = spacing,
                           .threads = threads};
  OLX_TRY(olx_lamp_light_create(&s->lamps, scene, scene->lights, scene->light_count));
  return olx_cell_table_create(&s->table, 1024);
}

void olx_light_surfels_free(olx_light_surfels *s) {
  olx_release(s->points);
  olx_release(s->surfels);
  olx_release(s->marks);
  olx_cell_table_free(&s->table);
  olx_near_lamps_free(&s->lamps);
  *s = (olx_light_surfels){0};
}

// A position on one side of a surface.
typedef struct place {
  olx_vec3 position, normal;
} place;

static place place_of(const olx_scene *scene, const olx_surfel_point *p) {
  const olx_vec3 a = olx_scene_corner(scene, p->triangle, 0), b = olx_scene_corner(scene, p->triangle, 1),
                 c = olx_scene_corner(scene, p->triangle, 2);
  const olx_vec3 outward = olx_normalize(olx_cross(olx_sub(b, a), olx_sub(c, a)));
  return (place){position_of(scene, p), p->back_face ? olx_negate(outward) : outward};
}

// Returns whether nothing lies between two neighbouring places, not even a pane that lets a part of the light pass.
static bool is_clear(const olx_light_surfels *s, place from, place to) {
  const float lift =
      LIFT_OF_DISTANCE * olx_length(olx_sub(to.position, from.position)) + LIFT_OF_WORLD * s->grid.coarsest;
  const olx_vec3 begin = olx_madd(from.position, from.normal, lift), end = olx_madd(to.position, to.normal, lift);
  const olx_ray ray = {.origin = begin, .direction = olx_sub(end, begin), .t_min = 0.0f, .t_max = 1.0f};
  return olx_bvh_transmittance(s->scene->light_bvh, &ray) >= 1.0f;
}

bool olx_light_surfels_see(const olx_light_surfels *s, const olx_light_surfel *surfel, const olx_surface *surface) {
  const olx_vec3 way = olx_sub(surface->position, surfel->position);
  const float clear = CLEAR_SHARE * surfel->nearest, distance = olx_length(way);
  if (distance < clear && olx_dot(way, surfel->normal) >= -BEHIND_SHARE * distance) return true;
  return is_clear(s, (place){surface->position, surface->geometric_normal}, (place){surfel->position, surfel->normal});
}

// Returns the first of a cell's surfels, from `head` on, that sees the surface; OLX_CELL_NONE when none does.
static uint32_t seeing(const olx_light_surfels *s, uint32_t head, const olx_surface *surface) {
  while (head != OLX_CELL_NONE && !olx_light_surfels_see(s, &s->surfels[head], surface)) head = s->surfels[head].next;
  return head;
}

// A part of a cell, and the point in it that is nearest to its middle.
typedef struct cell_part {
  uint64_t key;
  uint32_t point;
  float distance; // squared
} cell_part;

static void offer_point(const olx_light_surfels *s, uint32_t point, uint32_t level, cell_part *parts, uint32_t *count) {
  const uint64_t key = olx_cell_at_level(s->points[point].key, level);
  const olx_vec3 position = position_of(s->scene, &s->points[point]);
  const olx_vec3 way = olx_sub(position, olx_cell_middle(&s->grid, position, level));
  const float distance = olx_dot(way, way);
  uint32_t at = 0;
  while (at < *count && parts[at].key != key) at++;
  if (at == *count) parts[(*count)++] = (cell_part){key, point, INFINITY};
  if (distance < parts[at].distance) parts[at] = (cell_part){key, point, distance};
}

// Finds the parts of a cell of `level` in which the points of a surfel lie; returns their number, 0 where the cell is
// not divided.
static uint32_t find_parts(const olx_light_surfels *s, const olx_light_surfel *surfel, uint64_t cell, uint32_t level,
                           cell_part parts[OLX_CELL_PARTS]) {
  uint32_t points = 0, count = 0;
  float footprint = INFINITY;
  for (uint32_t i = surfel->first_point; i < surfel->first_point + surfel->point_count; i++) {
    if (olx_cell_at_level(s->points[i].key, level) != cell) continue;
    points++;
    footprint = olx_min(footprint, s->points[i].footprint);
    offer_point(s, i, level - 1, parts, &count);
  }
  const bool small = 0.5f * olx_cell_side(&s->grid, level) < LEAST_FOOTPRINTS * footprint;
  return points < LEAST_POINTS || small ? 0 : count;
}

uint32_t olx_light_surfels_part(const olx_light_surfels *s, uint32_t surfel, const olx_light_surfel *whole,
                                olx_light_surfel parts[OLX_CELL_PARTS]) {
  const uint32_t level = olx_cell_level(&s->grid, whole->side);
  cell_part found[OLX_CELL_PARTS];
  if (level == 0) return 0;
  const uint32_t count = find_parts(s, &s->surfels[surfel], whole->cell, level, found);
  if (count == 0) return 0;
  uint32_t made = 1;
  parts[0] = *whole;
  parts[0].cell = olx_cell_at_level(whole->point.key, level - 1);
  parts[0].side = 0.5f * whole->side;
  for (uint32_t i = 0; i < count; i++) {
    if (found[i].key == parts[0].cell) continue;
    const place at = place_of(s->scene, &s->points[found[i].point]);
    olx_light_surfel *part = &parts[made++];
    *part = parts[0];
    part->cell = found[i].key;
    part->point = s->points[found[i].point];
    part->position = at.position;
    part->normal = at.normal;
    part->nearest = olx_max(whole->nearest - olx_length(olx_sub(at.position, whole->position)), 0.0f);
  }
  return made;
}

uint64_t olx_light_surfels_cell(const olx_cell_table *table, uint64_t finest_key) {
  uint64_t cell = 0;
  for (uint32_t level = FIRST_LEVEL + 1; level-- > 0;) {
    const uint64_t key = olx_cell_at_level(finest_key, level);
    if (olx_cell_table_get(table, key) == OLX_CELL_NONE) break;
    cell = key;
  }
  return cell;
}

olx_surfel_found olx_light_surfels_find(const olx_light_surfels *s, uint64_t finest_key, const olx_surface *surface,
                                        float most_side) {
  olx_surfel_found found = {.surfel = OLX_CELL_NONE};
  for (uint32_t level = FIRST_LEVEL + 1; level-- > 0;) {
    const uint32_t value = olx_cell_table_get(&s->table, olx_cell_at_level(finest_key, level));
    if (value == OLX_CELL_NONE) break;
    found.surfel = value & ~OLX_CELL_DIVIDED;
    found.side = value & OLX_CELL_DIVIDED ? olx_cell_side(&s->grid, level) : 0.0f;
  }
  if (found.surfel == OLX_CELL_NONE) return found;
  found.surfel = found.side > most_side ? OLX_CELL_NONE : seeing(s, found.surfel, surface);
  return found;
}

// A group of points of a cell that are all visible from one of them, the position of the surfel.
typedef struct point_group {
  uint32_t chosen, end; // the chosen point, and the end of the group in the batch
  float nearest;
} point_group;

// A cell that is to be divided or to get surfels, and the results of examining it.
typedef struct cell_work {
  uint32_t first, end, level; // range of points in the batch, and level
  uint32_t group_count;       // 0: the cell is divided
  point_group groups[MOST_GROUPS];
} cell_work;

typedef struct cell_round {
  olx_light_surfels *surfels;
  olx_surfel_point *points;
  cell_work *cells;
  uint32_t count;
  uint32_t least_points; // cells with fewer are not divided
} cell_round;

// Chooses the point from `first` on that is nearest to the centre of the cell, so that surfels of neighbouring cells
// are evenly spaced.
static uint32_t choose_point(const cell_round *r, const cell_work *cell, uint32_t first) {
  const olx_scene *scene = r->surfels->scene;
  const olx_vec3 middle = olx_cell_middle(&r->surfels->grid, position_of(scene, &r->points[cell->first]), cell->level);
  uint32_t best = first;
  float least = INFINITY;
  for (uint32_t i = first; i < cell->end; i++) {
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

// Measures the geometric mean distance to what a surface sees, in units of `side`, and the least distance in metres.
// The sky counts as the farthest of the other distances. (Logarithms are of ratios to a power of two, so that they do
// not depend on the unit of length.)
static float explore(const olx_light_surfels *s, const olx_surface *surface, uint64_t cell, float side,
                     float *nearest) {
  olx_ray rays[EXPLORING_RAYS];
  olx_ray_hit hits[EXPLORING_RAYS];
  const uint32_t seed = olx_hash3((uint32_t)cell, (uint32_t)(cell >> 32), SALT_EXPLORE);
  for (uint32_t i = 0; i < EXPLORING_RAYS; i++) {
    const olx_vec3 local = olx_sample_cosine(olx_stratified2(i, seed));
    rays[i] = olx_surface_ray(surface, olx_from_basis(local, surface->geometric_normal), INFINITY);
  }
  olx_bvh_intersect_many(s->scene->light_bvh, rays, EXPLORING_RAYS, false, hits);
  float sum = 0.0f, farthest = 0.0f;
  uint32_t found = 0;
  *nearest = INFINITY;
  for (uint32_t i = 0; i < EXPLORING_RAYS; i++) {
    if (hits[i].triangle == OLX_NO_HIT) continue;
    const float distance = olx_max(hits[i].t, s->grid.finest) / side;
    sum += logf(distance);
    farthest = olx_max(farthest, distance);
    *nearest = olx_min(*nearest, hits[i].t);
    found++;
  }
  if (found == 0) return INFINITY;
  return expf((sum + (float)(EXPLORING_RAYS - found) * logf(farthest)) / EXPLORING_RAYS);
}

// Returns whether all points from `first` on are likely to see the chosen one, by a test of some of them.
static bool seem_clear(const cell_round *r, uint32_t first, uint32_t end, place chosen) {
  const uint32_t count = end - first, tried = count < TRIED_POINTS ? count : TRIED_POINTS;
  for (uint32_t i = 0; i < tried; i++) {
    const uint32_t at = first + (uint32_t)((uint64_t)count * (2 * i + 1) / (2 * tried));
    if (!is_clear(r->surfels, place_of(r->surfels->scene, &r->points[at]), chosen)) return false;
  }
  return true;
}

// Moves the points from `first` on that see the chosen one to the front; returns the end of that range.
static uint32_t part(const cell_round *r, uint32_t first, uint32_t end, place chosen) {
  for (uint32_t i = first; i < end; i++) {
    const olx_surfel_point point = r->points[i];
    if (!is_clear(r->surfels, place_of(r->surfels->scene, &point), chosen)) continue;
    r->points[i] = r->points[first];
    r->points[first++] = point;
  }
  return first;
}

// Divides the points of a cell that is not subdivided into groups, the first of which is given.
static void make_groups(const cell_round *r, cell_work *cell) {
  const olx_light_surfels *s = r->surfels;
  for (uint32_t first = cell->first; first < cell->end;) {
    point_group *group = &cell->groups[cell->group_count++];
    if (cell->group_count > 1) {
      group->chosen = choose_point(r, cell, first);
      const olx_surface surface = olx_surfel_point_surface(s->scene, &r->points[group->chosen]);
      explore(s, &surface, olx_cell_at_level(r->points[group->chosen].key, cell->level),
              olx_cell_side(&s->grid, cell->level), &group->nearest);
    }
    const olx_surfel_point chosen = r->points[group->chosen];
    r->points[group->chosen] = r->points[first];
    r->points[first] = chosen;
    group->chosen = first;
    const place middle = place_of(s->scene, &chosen);
    const bool whole = cell->group_count == MOST_GROUPS || seem_clear(r, first + 1, cell->end, middle);
    group->end = whole ? cell->end : part(r, first + 1, cell->end, middle);
    first = group->end;
  }
}

// Returns the geometric mean distance, in sides of the cell, to what point i sees, one of a set of points spread over
// the cell.
static float explore_point(const cell_round *r, const cell_work *cell, uint32_t i) {
  const uint32_t count = cell->end - cell->first;
  const uint32_t offset = (uint32_t)((uint64_t)count * (2 * i + 1) / (2 * EXPLORED_POINTS));
  const olx_surfel_point *point = &r->points[cell->first + offset];
  const olx_surface surface = olx_surfel_point_surface(r->surfels->scene, point);
  float nearest;
  return explore(r->surfels, &surface, point->key, olx_cell_side(&r->surfels->grid, cell->level), &nearest);
}

static void examine_cell(const cell_round *r, cell_work *cell) {
  const olx_light_surfels *s = r->surfels;
  point_group *group = &cell->groups[0];
  group->chosen = choose_point(r, cell, cell->first);
  const float side = olx_cell_side(&s->grid, cell->level);
  const olx_surface surface = olx_surfel_point_surface(s->scene, &r->points[group->chosen]);
  const uint64_t key = olx_cell_at_level(r->points[group->chosen].key, cell->level);
  float mean = explore(s, &surface, key, side, &group->nearest);
  const bool small = cell->level == 0 || cell->end - cell->first < r->least_points ||
                     0.5f * side < LEAST_FOOTPRINTS * least_footprint(r, cell);
  for (uint32_t i = 0; i < EXPLORED_POINTS && !small && s->spacing * mean >= 1.0f; i++) {
    mean = olx_min(mean, explore_point(r, cell, i));
  }
  if (small || s->spacing * mean >= 1.0f) make_groups(r, cell);
}

static void examine_cells(void *user, uint32_t job) {
  cell_round *r = user;
  const uint32_t end = (job + 1) * CELLS_PER_JOB < r->count ? (job + 1) * CELLS_PER_JOB : r->count;
  for (uint32_t i = job * CELLS_PER_JOB; i < end; i++) examine_cell(r, &r->cells[i]);
}

// Returns the end of the range of points from `first` on that lie in one cell of `level`.
static uint32_t end_of_cell(const olx_surfel_point *points, uint32_t first, uint32_t end, uint32_t level) {
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

// Finds the cells of `level` that hold points from `first` to `end`; returns their number.
static uint32_t split(const olx_surfel_point *points, uint32_t first, uint32_t end, uint32_t level, cell_work *cells) {
  uint32_t count = 0;
  while (first < end) {
    const uint32_t next = end_of_cell(points, first, end, level);
    cells[count++] = (cell_work){.first = first, .end = next, .level = level};
    first = next;
  }
  return count;
}

// Appends one surfel for the points from first to group->end of a cell.
static olx_result append_surfel(olx_light_surfels *s, const cell_round *r, const cell_work *cell,
                                const point_group *group, uint32_t first, uint32_t base) {
  if (s->count == s->capacity) {
    const uint32_t capacity = s->capacity ? 2 * s->capacity : 4096;
    olx_light_surfel *larger = olx_allocate(capacity, sizeof *larger);
    if (!larger) return olx_fail(OLX_ERROR_MEMORY, "light: out of memory for %u surfels", capacity);
    for (uint32_t i = 0; i < s->count; i++) larger[i] = s->surfels[i];
    olx_release(s->surfels);
    s->surfels = larger;
    s->capacity = capacity;
  }
  const olx_surfel_point *point = &r->points[group->chosen];
  const place at = place_of(s->scene, point);
  s->surfels[s->count++] = (olx_light_surfel){.cell = olx_cell_at_level(point->key, cell->level),
                                              .point = *point,
                                              .position = at.position,
                                              .normal = at.normal,
                                              .side = olx_cell_side(&s->grid, cell->level),
                                              .nearest = group->nearest,
                                              .first_point = base + first,
                                              .point_count = group->end - first,
                                              .next = OLX_CELL_NONE};
  return OLX_OK;
}

// Appends a surfel for each group of a cell. Existing surfels of the cell stay ahead of the new ones.
static olx_result append_cell(olx_light_surfels *s, const cell_round *r, const cell_work *cell, uint32_t base) {
  const uint64_t key = olx_cell_at_level(r->points[cell->first].key, cell->level);
  const uint32_t old = olx_cell_table_get(&s->table, key);
  uint32_t first = cell->first, last = old == OLX_CELL_NONE || old & OLX_CELL_DIVIDED ? OLX_CELL_NONE : old;
  if (last == OLX_CELL_NONE) OLX_TRY(olx_cell_table_set(&s->table, key, s->count));
  while (last != OLX_CELL_NONE && s->surfels[last].next != OLX_CELL_NONE) last = s->surfels[last].next;
  for (uint32_t i = 0; i < cell->group_count; i++) {
    OLX_TRY(append_surfel(s, r, cell, &cell->groups[i], first, base));
    if (last != OLX_CELL_NONE) s->surfels[last].next = s->count - 1;
    last = s->count - 1;
    first = cell->groups[i].end;
  }
  return OLX_OK;
}

// Assigns a new surfel to the divided cells around it that have none yet.
static olx_result stand_for_divided(olx_light_surfels *s, uint32_t surfel, uint32_t level) {
  const uint64_t finest = s->surfels[surfel].point.key;
  while (++level <= FIRST_LEVEL) {
    const uint64_t key = olx_cell_at_level(finest, level);
    if (olx_cell_table_get(&s->table, key) != OLX_CELL_NONE) break;
    OLX_TRY(olx_cell_table_set(&s->table, key, surfel | OLX_CELL_DIVIDED));
  }
  return OLX_OK;
}

// Turns the examined cells into surfels, or into smaller cells in `next`; returns the number of smaller cells.
static olx_result settle_round(cell_round *r, uint32_t base, cell_work *next, uint32_t *next_count) {
  olx_light_surfels *s = r->surfels;
  *next_count = 0;
  for (uint32_t i = 0; i < r->count; i++) {
    const cell_work *cell = &r->cells[i];
    if (cell->group_count == 0) {
      *next_count += split(r->points, cell->first, cell->end, cell->level - 1, next + *next_count);
      continue;
    }
    OLX_TRY(append_cell(s, r, cell, base));
    OLX_TRY(stand_for_divided(s, s->count - 1, cell->level));
  }
  return OLX_OK;
}

static olx_result divide_cells(olx_light_surfels *s, olx_surfel_point *points, uint32_t count, uint32_t base,
                               cell_work *cells, cell_work *next) {
  cell_round r = {
      .surfels = s, .points = points, .cells = cells, .least_points = base == 0 ? LEAST_POINTS : LEAST_HIDDEN_POINTS};
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

// Sorts points by cube face first, so that the points of a cell are consecutive on every level.
static int by_cell(const void *a, const void *b) {
  const olx_surfel_point *p = a, *q = b;
  const uint64_t first = olx_cell_order(p->key), second = olx_cell_order(q->key);
  if (first != second) return first < second ? -1 : 1;
  if (p->triangle != q->triangle) return p->triangle < q->triangle ? -1 : 1;
  if (p->u != q->u) return p->u < q->u ? -1 : 1;
  return p->v < q->v ? -1 : p->v > q->v;
}

// Appends the points of the surfels, cell by cell.
static olx_result keep_points(olx_light_surfels *s, const olx_surfel_point *points, uint32_t count) {
  olx_surfel_point *all = olx_allocate((size_t)s->point_count + count, sizeof *all);
  if (!all) return olx_fail(OLX_ERROR_MEMORY, "light: out of memory for %u points of surfaces", count);
  for (uint32_t i = 0; i < s->point_count; i++) all[i] = s->points[i];
  for (uint32_t i = 0; i < count; i++) all[s->point_count + i] = points[i];
  qsort(all + s->point_count, count, sizeof *all, by_cell);
  olx_release(s->points);
  s->points = all;
  s->point_count += count;
  return OLX_OK;
}

olx_result olx_light_surfels_add(olx_light_surfels *s, const olx_surfel_point *points, uint32_t count) {
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
