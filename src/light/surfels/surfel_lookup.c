// Finds the surfels around a surface point and fits a plane to their light, which hides their spacing and their noise:
// a first-order moving least squares fit, with a small penalty on slopes.
#include "light/surfels/surfel_lookup.h"

#include "core/hooks.h"
#include "core/result.h"

#include <stdlib.h>

// Radius of a surfel's influence, in sides of its cell, and its multiple where surfels farther away are wanted.
static const float REACH = 1.2f, WIDER = 2.0f;
// Most distance of a point from a surfel's plane: this share of the cell's side, plus the distance between them times
// the sine of the angle between their normals or this share, whichever is less. Between parallel planes there is a
// step, such as that from a wall to a frame on it.
static const float PLANE_OF_SIDE = 0.04f, PLANE_OF_DISTANCE = 0.2f;
static const float LEAST_NORMAL_COSINE = 0.85f;
// Least cosine between any direction along the surface and the way to some surfel, where surfels farther away are
// wanted.
static const float LEAST_AHEAD = 0.5f;
static const float SLOPE_PENALTY = 0.01f;

typedef struct cube_entry {
  uint64_t cube;
  uint32_t surfel;
} cube_entry;

typedef struct entry_list {
  cube_entry *entries;
  size_t count, capacity;
} entry_list;

static olx_result add_entry(entry_list *list, uint64_t cube, uint32_t surfel) {
  if (list->count == list->capacity) {
    const size_t capacity = list->capacity ? 2 * list->capacity : 65536;
    cube_entry *larger = olx_allocate(capacity, sizeof *larger);
    if (!larger) return olx_fail(OLX_ERROR_MEMORY, "light: out of memory for finding surfels");
    for (size_t i = 0; i < list->count; i++) larger[i] = list->entries[i];
    olx_release(list->entries);
    list->entries = larger;
    list->capacity = capacity;
  }
  list->entries[list->count++] = (cube_entry){cube, surfel};
  return OLX_OK;
}

// Returns the key of a cube, like that of a cell but without a normal.
static uint64_t cube_key(const olx_cell_grid *grid, olx_vec3 position, uint32_t level) {
  return olx_cell_at_level(olx_cell_key(grid, position, olx_v3(0.0f, 1.0f, 0.0f)), level);
}

// Adds all cubes of the surfel's level that its influence touches near its plane.
static olx_result add_cubes(const olx_light_surfels *s, uint32_t number, entry_list *list) {
  const olx_light_surfel *surfel = &s->surfels[number];
  const uint32_t level = olx_cell_level(&s->grid, surfel->side);
  const olx_vec3 middle = olx_cell_middle(&s->grid, surfel->position, level);
  for (int32_t z = -2; z <= 2; z++) {
    for (int32_t y = -2; y <= 2; y++) {
      for (int32_t x = -2; x <= 2; x++) {
        const olx_vec3 cube = olx_madd(middle, olx_v3((float)x, (float)y, (float)z), surfel->side);
        const olx_vec3 way = olx_sub(cube, surfel->position);
        // Half the diagonal of a cube is 0.87 of its side.
        if (fabsf(olx_dot(way, surfel->normal)) > (0.87f + PLANE_OF_DISTANCE * REACH) * surfel->side) continue;
        if (olx_length(way) > (0.87f + REACH) * surfel->side) continue;
        OLX_TRY(add_entry(list, cube_key(&s->grid, cube, level), number));
      }
    }
  }
  return OLX_OK;
}

static int by_cube(const void *a, const void *b) {
  const cube_entry *p = a, *q = b;
  if (p->cube != q->cube) return p->cube < q->cube ? -1 : 1;
  return p->surfel < q->surfel ? -1 : p->surfel > q->surfel;
}

// Turns sorted entries into lists.
static olx_result make_lists(olx_surfel_lookup *l, const entry_list *list) {
  size_t cubes = 0;
  for (size_t i = 0; i < list->count; i++) cubes += i == 0 || list->entries[i].cube != list->entries[i - 1].cube;
  l->lists = olx_allocate(list->count + cubes, sizeof *l->lists);
  if (!l->lists) return olx_fail(OLX_ERROR_MEMORY, "light: out of memory for finding surfels");
  OLX_TRY(olx_cell_table_create(&l->cubes, (uint32_t)cubes));
  l->list_words = (uint32_t)(list->count + cubes);
  uint32_t head = 0, end = 0;
  for (size_t i = 0; i < list->count; i++) {
    if (i == 0 || list->entries[i].cube != list->entries[i - 1].cube) {
      head = end++;
      l->lists[head] = 0;
      OLX_TRY(olx_cell_table_set(&l->cubes, list->entries[i].cube, head));
    }
    l->lists[head]++;
    l->lists[end++] = list->entries[i].surfel;
  }
  return OLX_OK;
}

olx_result olx_surfel_lookup_create(olx_surfel_lookup *l, const olx_light_surfels *surfels, uint32_t count) {
  *l = (olx_surfel_lookup){.surfels = surfels};
  entry_list list = {0};
  olx_result result = OLX_OK;
  for (uint32_t i = 0; result == OLX_OK && i < count; i++) {
    l->levels |= 1u << olx_cell_level(&surfels->grid, surfels->surfels[i].side);
    result = add_cubes(surfels, i, &list);
  }
  if (result == OLX_OK) {
    if (list.count > 0) qsort(list.entries, list.count, sizeof *list.entries, by_cube);
    result = make_lists(l, &list);
  }
  olx_release(list.entries);
  return result;
}

void olx_surfel_lookup_free(olx_surfel_lookup *l) {
  olx_cell_table_free(&l->cubes);
  olx_release(l->lists);
  *l = (olx_surfel_lookup){0};
}

// A surfel that may contribute to a point.
typedef struct neighbour {
  uint32_t surfel;
  float weight, x, y; // weight, and offset in the point's tangent plane, metres
} neighbour;

typedef struct neighbourhood {
  olx_vec3 tangent, bitangent; // of the point's surface
  float wider;                 // multiple of the radii of influence
  uint32_t count;
  neighbour members[OLX_NEIGHBOURS_MOST];
} neighbourhood;

// Keeps the neighbours with the largest weights.
static void add_neighbour(neighbourhood *n, neighbour found) {
  for (uint32_t i = 0; i < n->count; i++) {
    if (n->members[i].surfel == found.surfel) return;
  }
  if (n->count < OLX_NEIGHBOURS_MOST) {
    n->members[n->count++] = found;
    return;
  }
  uint32_t least = 0;
  for (uint32_t i = 1; i < n->count; i++) {
    if (n->members[i].weight < n->members[least].weight) least = i;
  }
  if (found.weight > n->members[least].weight) n->members[least] = found;
}

// Adds a surfel to the neighbourhood. Weights are inverse to the square of the cell's side, so that surfels count by
// density as well as by distance, and small ones dominate where large cells meet small ones.
static void consider(const olx_light_surfels *s, uint32_t number, const olx_surface *surface, neighbourhood *n) {
  const olx_light_surfel *surfel = &s->surfels[number];
  const olx_vec3 way = olx_sub(surfel->position, surface->position);
  const float reach = n->wider * REACH * surfel->side, squared = olx_dot(way, way);
  if (squared >= reach * reach) return;
  const float cosine = olx_dot(surfel->normal, surface->geometric_normal);
  if (cosine < LEAST_NORMAL_COSINE) return;
  const float distance = sqrtf(squared), sine = sqrtf(olx_max(1.0f - cosine * cosine, 0.0f));
  const float off = PLANE_OF_SIDE * surfel->side + olx_min(sine, PLANE_OF_DISTANCE) * distance;
  if (fabsf(olx_dot(way, surfel->normal)) > off || fabsf(olx_dot(way, surface->geometric_normal)) > off) return;
  // Both powers of the distance give about the same mean square distance.
  const float close = 1.0f - distance / reach, closer = n->wider > 1.0f ? close * close * close : close;
  const float near = closer * s->grid.finest / surfel->side;
  add_neighbour(
      n, (neighbour){
             .surfel = number, .weight = near * near, .x = olx_dot(way, n->tangent), .y = olx_dot(way, n->bitangent)});
}

static void drop_hidden(const olx_light_surfels *s, const olx_surface *surface, neighbourhood *n) {
  uint32_t kept = 0;
  for (uint32_t i = 0; i < n->count; i++) {
    if (olx_light_surfels_see(s, &s->surfels[n->members[i].surfel], surface)) n->members[kept++] = n->members[i];
  }
  n->count = kept;
}

static void collect_cube(const olx_surfel_lookup *l, const olx_surface *surface, uint64_t cube, neighbourhood *n) {
  const uint32_t at = olx_cell_table_get(&l->cubes, cube);
  if (at == OLX_CELL_NONE) return;
  for (uint32_t i = 0; i < l->lists[at]; i++) consider(l->surfels, l->lists[at + 1 + i], surface, n);
}

// Considers the surfels of the cubes around the point's, too, where their influence reaches farther than they are
// listed.
static void collect_around(const olx_surfel_lookup *l, const olx_surface *surface, uint32_t level, neighbourhood *n) {
  const float side = olx_cell_side(&l->surfels->grid, level);
  for (int32_t y = -1; y <= 1; y++) {
    for (int32_t x = -1; x <= 1; x++) {
      const olx_vec3 step = olx_add(olx_scale(n->tangent, (float)x * side), olx_scale(n->bitangent, (float)y * side));
      collect_cube(l, surface, cube_key(&l->surfels->grid, olx_add(surface->position, step), level), n);
    }
  }
}

static void collect(const olx_surfel_lookup *l, const olx_surface *surface, float wider, neighbourhood *n) {
  n->count = 0;
  n->wider = wider;
  const uint64_t finest = cube_key(&l->surfels->grid, surface->position, 0);
  for (uint32_t level = 0; l->levels >> level != 0; level++) {
    if (!(l->levels >> level & 1u)) continue;
    if (wider > 1.0f) collect_around(l, surface, level, n);
    else collect_cube(l, surface, olx_cell_at_level(finest, level), n);
  }
  drop_hidden(l->surfels, surface, n);
}

// Returns whether there are neighbours on all sides of the point, so that a fit to them does not extrapolate.
static bool is_surrounded(const neighbourhood *n) {
  enum { DIRECTIONS = 8 };
  for (uint32_t k = 0; k < DIRECTIONS; k++) {
    const float angle = 2.0f * OLX_PI * (float)k / DIRECTIONS, x = cosf(angle), y = sinf(angle);
    float most = 0.0f;
    for (uint32_t i = 0; i < n->count; i++) {
      const neighbour *m = &n->members[i];
      most = olx_max(most, (x * m->x + y * m->y) / sqrtf(m->x * m->x + m->y * m->y));
    }
    if (most < LEAST_AHEAD) return false;
  }
  return true;
}

// The moments of a neighbourhood, in units of its mean distance.
typedef struct moments {
  float w, x, y, xx, xy, yy;
} moments;

static moments sum_moments(const olx_surfel_weights *n) {
  moments sums = {0};
  for (uint32_t i = 0; i < n->count; i++) {
    const float w = n->near[i], x = n->way[i].x, y = n->way[i].y;
    sums.w += w;
    sums.x += w * x;
    sums.y += w * y;
    sums.xx += w * x * x;
    sums.xy += w * x * y;
    sums.yy += w * y * y;
  }
  sums.xx += SLOPE_PENALTY * sums.w;
  sums.yy += SLOPE_PENALTY * sums.w;
  return sums;
}

// A row of the inverse of the matrix of the normal equations, times `determinant`: the first gives the fit's value at
// the point, the others its slopes.
typedef struct fit_rows {
  olx_vec3 value, slope_x, slope_y;
  float determinant;
  bool regular;
} fit_rows;

static fit_rows invert(const moments *s) {
  fit_rows f = {.value = {s->xx * s->yy - s->xy * s->xy, s->xy * s->y - s->x * s->yy, s->x * s->xy - s->xx * s->y},
                .slope_x = {s->xy * s->y - s->x * s->yy, s->w * s->yy - s->y * s->y, s->x * s->y - s->w * s->xy},
                .slope_y = {s->x * s->xy - s->xx * s->y, s->x * s->y - s->w * s->xy, s->w * s->xx - s->x * s->x}};
  f.determinant = s->w * f.value.x + s->x * f.value.y + s->y * f.value.z;
  f.regular = f.determinant > 0.05f * s->w * s->xx * s->yy;
  return f;
}

static void copy(const neighbourhood *n, olx_surfel_weights *weights) {
  float distance = 0.0f, weight = 0.0f;
  for (uint32_t i = 0; i < n->count; i++) {
    const neighbour *m = &n->members[i];
    distance += m->weight * sqrtf(m->x * m->x + m->y * m->y);
    weight += m->weight;
  }
  const float scale = distance > 0.0f ? weight / distance : 0.0f;
  weights->count = n->count;
  for (uint32_t i = 0; i < n->count; i++) {
    const neighbour *m = &n->members[i];
    weights->surfel[i] = m->surfel;
    weights->near[i] = m->weight;
    weights->way[i] = (olx_vec2){m->x * scale, m->y * scale};
  }
}

// The value at the origin of the best-fitting plane is the sum of w_i (a + b x_i + c y_i) E_i, where a, b, c solve the
// normal equations for the unit vector of the constant term.
static void fit(olx_surfel_weights *weights) {
  const moments s = sum_moments(weights);
  const fit_rows f = invert(&s);
  float sum = 0.0f;
  for (uint32_t i = 0; i < weights->count; i++) {
    const olx_vec2 way = weights->way[i];
    const float w = weights->near[i];
    weights->weight[i] = f.regular ? w * olx_dot(f.value, olx_v3(1.0f, way.x, way.y)) : w;
    sum += weights->weight[i];
  }
  for (uint32_t i = 0; i < weights->count; i++) weights->weight[i] /= sum;
}

float olx_surfel_misfit(const olx_surfel_weights *weights, const float values[OLX_NEIGHBOURS_MOST]) {
  const moments s = sum_moments(weights);
  const fit_rows f = invert(&s);
  olx_vec3 right = {0}; // of the normal equations
  for (uint32_t i = 0; i < weights->count; i++) {
    const olx_vec2 way = weights->way[i];
    right = olx_madd(right, olx_v3(1.0f, way.x, way.y), weights->near[i] * values[i]);
  }
  const olx_vec3 plane =
      f.regular ? olx_scale(olx_v3(olx_dot(f.value, right), olx_dot(f.slope_x, right), olx_dot(f.slope_y, right)),
                            1.0f / f.determinant)
                : olx_v3(right.x / s.w, 0.0f, 0.0f);
  float squares = 0.0f;
  for (uint32_t i = 0; i < weights->count; i++) {
    const olx_vec2 way = weights->way[i];
    squares += weights->near[i] * olx_square(values[i] - olx_dot(plane, olx_v3(1.0f, way.x, way.y)));
  }
  return sqrtf(squares / s.w);
}

olx_surfel_weights olx_surfel_weigh(const olx_surfel_lookup *lookup, const olx_surface *surface, bool wide) {
  neighbourhood n = {0};
  olx_surfel_weights weights = {0};
  olx_basis(surface->geometric_normal, &n.tangent, &n.bitangent);
  collect(lookup, surface, wide ? WIDER : 1.0f, &n);
  if (wide && !is_surrounded(&n)) n.count = 0;
  copy(&n, &weights);
  if (n.count > 0) fit(&weights);
  return weights;
}
