#include "place/surfels.h"

#include "core/hooks.h"
#include "core/parallel.h"
#include "core/result.h"
#include "core/sampling.h"
#include "place/visibility.h"
#include "scene/bvh.h"
#include "scene/surface.h"

#include <stdlib.h>
#include <string.h>

enum {
  POINTS_A_JOB = 64,
  FIRST_RAYS = 16, // that mostly tell a surfel's fate
  MORE_RAYS = 80,  // when they do not
  VANTAGE_RAYS = 64
};

olx_sight olx_sight_create(const olx_scene *scene, float min_cosine, float max_footprint, uint32_t resolution) {
  return (olx_sight){
      .min_cosine = min_cosine,
      .max_footprint = max_footprint * olx_length(olx_sub(scene->bounds_max, scene->bounds_min)),
      .texel_radians = sqrtf(4.0f * OLX_PI) / (float)resolution,
  };
}

// Every third bit, from bit 0.
static uint64_t spread_bits(uint64_t x) {
  x &= 0x1FFFFF;
  x = (x | x << 32) & 0x1F00000000FFFF;
  x = (x | x << 16) & 0x1F0000FF0000FF;
  x = (x | x << 8) & 0x100F00F00F00F00F;
  x = (x | x << 4) & 0x10C30C30C30C30C3;
  return (x | x << 2) & 0x1249249249249249;
}

typedef struct morton_entry {
  uint64_t code;
  uint32_t index;
} morton_entry;

static int compare_entries(const void *a, const void *b) {
  const morton_entry *x = a, *y = b;
  if (x->code != y->code) return x->code < y->code ? -1 : 1;
  return x->index < y->index ? -1 : x->index > y->index;
}

static uint64_t morton_code(const olx_scene *scene, olx_vec3 p) {
  const olx_vec3 extent = olx_sub(scene->bounds_max, scene->bounds_min);
  const float scale = (float)((1 << 20) - 1) / olx_max(olx_max3(extent), 1e-30f);
  const olx_vec3 q = olx_scale(olx_sub(p, scene->bounds_min), scale);
  return spread_bits((uint64_t)olx_max(q.x, 0.0f)) | spread_bits((uint64_t)olx_max(q.y, 0.0f)) << 1 |
         spread_bits((uint64_t)olx_max(q.z, 0.0f)) << 2;
}

static olx_vec3 corner(const olx_scene *scene, uint32_t triangle, uint32_t i) {
  return scene->positions[scene->indices[3 * (size_t)triangle + i]];
}

// Cross product of two edges: along the winding's normal, twice the area long.
static olx_vec3 doubled_area(const olx_scene *scene, uint32_t triangle) {
  const olx_vec3 a = corner(scene, triangle, 0);
  return olx_cross(olx_sub(corner(scene, triangle, 1), a), olx_sub(corner(scene, triangle, 2), a));
}

// A point drawn on a triangle, the `nth` there.
typedef struct drawn_point {
  uint32_t triangle, nth;
} drawn_point;

typedef struct atlas_maker {
  const olx_space *space;
  const olx_sight *sight;
  drawn_point *points;
  olx_surfel *sides; // two a point
  uint8_t *present;  // a point: not in a masked-out part
  uint32_t count, seed;
} atlas_maker;

static olx_result order_triangles(const olx_scene *scene, morton_entry **order) {
  *order = olx_allocate(scene->triangle_count, sizeof **order);
  if (!*order) return olx_fail(OLX_ERROR_MEMORY, "place: no memory for %u triangles", scene->triangle_count);
  for (uint32_t t = 0; t < scene->triangle_count; t++) {
    const olx_vec3 sum = olx_add(corner(scene, t, 0), olx_add(corner(scene, t, 1), corner(scene, t, 2)));
    (*order)[t] = (morton_entry){morton_code(scene, olx_scale(sum, 1.0f / 3.0f)), t};
  }
  qsort(*order, scene->triangle_count, sizeof **order, compare_entries);
  return OLX_OK;
}

// Equal steps of area along the triangles, which lie in the order of the Morton curve.
static olx_result draw_points(atlas_maker *m, double *area) {
  const olx_scene *scene = m->space->scene;
  morton_entry *order;
  OLX_TRY(order_triangles(scene, &order));
  double total = 0.0, reached = 0.0;
  for (uint32_t t = 0; t < scene->triangle_count; t++) total += 0.5 * (double)olx_length(doubled_area(scene, t));
  const double step = total / m->count, offset = (double)olx_unit_float(olx_hash(m->seed));
  uint32_t drawn = 0;
  for (uint32_t i = 0; i < scene->triangle_count; i++) {
    const uint32_t triangle = order[i].index;
    reached += 0.5 * (double)olx_length(doubled_area(scene, triangle));
    for (uint32_t nth = 0; drawn < m->count && (drawn + offset) * step < reached; nth++, drawn++) {
      m->points[drawn] = (drawn_point){triangle, nth};
    }
  }
  olx_release(order);
  m->count = drawn;
  *area = step;
  return total > 0.0 ? OLX_OK : olx_fail(OLX_ERROR_EMPTY, "nothing to see: the scene's triangles have no area");
}

static void set_up_sides(const atlas_maker *m, uint32_t index) {
  const olx_scene *scene = m->space->scene;
  const drawn_point at = m->points[index];
  const olx_vec2 uv = olx_sample_triangle(olx_stratified2(at.nth, olx_hash2(m->seed, at.triangle)));
  m->present[index] = olx_surface_present(scene, at.triangle, uv.x, uv.y);
  const olx_vec3 a = corner(scene, at.triangle, 0), b = corner(scene, at.triangle, 1),
                 c = corner(scene, at.triangle, 2);
  const olx_vec3 p = olx_madd(olx_madd(a, olx_sub(b, a), uv.x), olx_sub(c, a), uv.y);
  const float epsilon = olx_surface_epsilon(scene, at.triangle);
  // A step off the edges, where walls meet, as the renderer's rays take it.
  const olx_vec3 way = olx_sub(olx_scale(olx_add(a, olx_add(b, c)), 1.0f / 3.0f), p);
  const olx_vec3 moved = olx_madd(p, way, olx_min(1.0f, epsilon / olx_max(olx_length(way), 1e-30f)));
  const olx_vec3 normal = olx_normalize(doubled_area(scene, at.triangle));
  for (uint32_t side = 0; side < 2; side++) {
    const olx_vec3 n = side ? olx_negate(normal) : normal;
    m->sides[2 * index + side] = (olx_surfel){
        .position = olx_madd(moved, n, epsilon), .normal = n, .triangle = at.triangle, .fate = OLX_SURFEL_UNSEEN};
  }
}

static olx_vec3 hemisphere_direction(olx_vec3 normal, olx_vec2 random) {
  const float phi = 2.0f * OLX_PI * random.y, r = sqrtf(olx_max(0.0f, 1.0f - random.x * random.x));
  return olx_from_basis(olx_v3(r * cosf(phi), r * sinf(phi), random.x), normal);
}

// The farthest from which a surfel is seen well under that cosine; 0 when it is grazing.
static float sight_limit(const olx_sight *sight, float cosine) {
  return cosine < sight->min_cosine ? 0.0f : sight->max_footprint * cosine / sight->texel_radians;
}

// Rays over the hemisphere, with what stops them.
static void cast_around(const olx_space *space, const olx_surfel *surfel, uint32_t seed, uint32_t first, uint32_t count,
                        olx_ray *rays, olx_ray_hit *hits) {
  for (uint32_t i = 0; i < count; i++) {
    const olx_vec3 direction = hemisphere_direction(surfel->normal, olx_stratified2(first + i, seed));
    rays[i] = (olx_ray){surfel->position, direction, 0.0f, INFINITY};
  }
  olx_bvh_intersect_many(space->scene->bvh, rays, count, false, hits);
}

// The part of a ray along which there is space.
typedef struct reach {
  float start, end;
} reach;

static reach reach_of(const olx_space *space, const olx_ray *ray, const olx_ray_hit *hit) {
  reach r = {0.0f, hit->triangle == OLX_NO_HIT ? INFINITY : hit->t};
  if (!olx_voxels_clip(&space->voxels, ray->origin, ray->direction, &r.start, &r.end)) r.end = r.start;
  return r;
}

// Bits of what lies along the ray: OLX_REACHABLE, OLX_ALLOWED, and FIT for a place that allows a probe and sees well.
enum { FIT = 4 };
static uint8_t along_ray(const olx_space *space, const olx_sight *sight, const olx_surfel *surfel, const olx_ray *ray,
                         reach r) {
  const float limit = sight_limit(sight, olx_dot(ray->direction, surfel->normal)), step = 0.5f * space->voxels.size;
  uint8_t found = 0;
  for (float t = r.start + 0.25f * step; t < r.end; t += step) {
    const size_t voxel = olx_voxel_at(&space->voxels, olx_madd(ray->origin, ray->direction, t));
    if (voxel == OLX_NO_VOXEL) continue;
    found |= space->reachable[voxel];
    if (found & OLX_ALLOWED) return t <= limit ? found | FIT : found;
  }
  return found;
}

static olx_surfel_fate find_fate(const atlas_maker *m, const olx_surfel *surfel, uint32_t seed) {
  olx_ray rays[MORE_RAYS];
  olx_ray_hit hits[MORE_RAYS];
  uint8_t found = 0;
  for (uint32_t round = 0; round < 2; round++) {
    const uint32_t first = round ? FIRST_RAYS : 0, count = round ? MORE_RAYS : FIRST_RAYS;
    cast_around(m->space, surfel, seed, first, count, rays, hits);
    for (uint32_t i = 0; i < count; i++) {
      found |= along_ray(m->space, m->sight, surfel, &rays[i], reach_of(m->space, &rays[i], &hits[i]));
      if (found & FIT) return OLX_SURFEL_FIT;
    }
  }
  return found & OLX_ALLOWED ? OLX_SURFEL_GRAZING : found & OLX_REACHABLE ? OLX_SURFEL_RESTRICTED : OLX_SURFEL_UNSEEN;
}

static void fate_job(void *user, uint32_t index) {
  const atlas_maker *m = user;
  const uint32_t first = index * POINTS_A_JOB;
  for (uint32_t i = first; i < first + POINTS_A_JOB && i < m->count; i++) {
    set_up_sides(m, i);
    for (uint32_t side = 0; m->present[i] && side < 2; side++) {
      olx_surfel *surfel = &m->sides[2 * i + side];
      surfel->fate = find_fate(m, surfel, olx_hash3(m->seed, i, side));
    }
  }
}

// Keep the sides that are seen, along the Morton curve.
static olx_result collect(const atlas_maker *m, olx_surfels *surfels) {
  const olx_scene *scene = m->space->scene;
  uint32_t present = 0, unseen = 0;
  for (uint32_t i = 0; i < m->count; i++) {
    const bool first = m->sides[2 * i].fate != OLX_SURFEL_UNSEEN, second = m->sides[2 * i + 1].fate != OLX_SURFEL_UNSEEN;
    present += m->present[i];
    unseen += m->present[i] && !first && !second;
    surfels->count += (uint32_t)first + (uint32_t)second;
  }
  surfels->unreachable = present ? (double)unseen / present : 0.0;
  surfels->items = olx_allocate(surfels->count, sizeof *surfels->items);
  morton_entry *order = olx_allocate(surfels->count, sizeof *order);
  if (!surfels->items || !order) {
    olx_release(order);
    return olx_fail(OLX_ERROR_MEMORY, "place: no memory for %u surfels", surfels->count);
  }
  uint32_t used = 0;
  for (uint32_t i = 0; i < 2 * m->count; i++) {
    if (m->sides[i].fate == OLX_SURFEL_UNSEEN) continue;
    order[used++] = (morton_entry){morton_code(scene, m->sides[i].position), i};
  }
  qsort(order, used, sizeof *order, compare_entries);
  for (uint32_t i = 0; i < used; i++) surfels->items[i] = m->sides[order[i].index];
  olx_release(order);
  return OLX_OK;
}

olx_result olx_surfels_create(const olx_space *space, const olx_sight *sight, uint32_t points, uint32_t seed,
                              uint32_t threads, olx_surfels *surfels) {
  *surfels = (olx_surfels){0};
  atlas_maker m = {.space = space, .sight = sight, .count = points, .seed = seed};
  m.points = olx_allocate(points, sizeof *m.points);
  m.sides = olx_allocate(2 * (size_t)points, sizeof *m.sides);
  m.present = olx_allocate(points, 1);
  olx_result result = OLX_ERROR_MEMORY;
  if (m.points && m.sides && m.present) {
    result = draw_points(&m, &surfels->area);
    const uint32_t jobs = (m.count + POINTS_A_JOB - 1) / POINTS_A_JOB;
    if (result == OLX_OK) result = olx_parallel_for(jobs, threads, fate_job, &m, NULL, 0);
    if (result == OLX_OK) result = collect(&m, surfels);
  } else {
    olx_fail(result, "place: no memory for %u surfels", points);
  }
  olx_release(m.points);
  olx_release(m.sides);
  olx_release(m.present);
  if (result != OLX_OK) olx_surfels_free(surfels);
  return result;
}

void olx_surfels_free(olx_surfels *surfels) {
  olx_release(surfels->items);
  surfels->items = NULL;
  surfels->count = 0;
}

// One of the fit places along the ray, each as likely.
static bool pick_place(const olx_space *space, const olx_sight *sight, const olx_surfel *surfel, const olx_ray *ray,
                       reach r, uint32_t seed, olx_vec3 *place) {
  const float limit = olx_min(r.end, sight_limit(sight, olx_dot(ray->direction, surfel->normal)));
  const float step = 0.5f * space->voxels.size;
  uint32_t fit = 0;
  for (float t = r.start + 0.25f * step; t < limit; t += step) {
    const olx_vec3 p = olx_madd(ray->origin, ray->direction, t);
    const size_t voxel = olx_voxel_at(&space->voxels, p);
    if (voxel == OLX_NO_VOXEL || !(space->reachable[voxel] & OLX_ALLOWED)) continue;
    fit++;
    if (olx_unit_float(olx_hash2(seed, fit)) * (float)fit < 1.0f) *place = p;
  }
  return fit > 0 && olx_space_allows(space, *place);
}

uint32_t olx_surfel_vantages(const olx_space *space, const olx_sight *sight, const olx_surfel *surfel, uint32_t seed,
                             uint32_t wanted, olx_vec3 *places) {
  olx_ray rays[VANTAGE_RAYS];
  olx_ray_hit hits[VANTAGE_RAYS];
  cast_around(space, surfel, seed, 0, VANTAGE_RAYS, rays, hits);
  uint32_t found = 0;
  for (uint32_t i = 0; i < VANTAGE_RAYS && found < wanted; i++) {
    const reach r = reach_of(space, &rays[i], &hits[i]);
    if (pick_place(space, sight, surfel, &rays[i], r, olx_hash2(seed, i), &places[found])) found++;
  }
  return found;
}
