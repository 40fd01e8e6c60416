// Spreads surfels over the surfaces of a scene by area and keeps those that are visible from the space that matters, as
// rays and lines of sight determine for each.
#include "place/cover/surfels.h"

#include "core/hooks.h"
#include "core/morton.h"
#include "core/parallel.h"
#include "core/result.h"
#include "core/sampling.h"
#include "scene/bvh.h"
#include "scene/surface.h"

#include <stdlib.h>
#include <string.h>

enum {
  POINTS_A_JOB = 64,
  FATE_ROUNDS = 3,
  MOST_RAYS = 64, // most rays of a round
  VANTAGE_RAYS = 64
};

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
  return olx_morton_spread((uint64_t)olx_max(q.x, 0.0f)) | olx_morton_spread((uint64_t)olx_max(q.y, 0.0f)) << 1 |
         olx_morton_spread((uint64_t)olx_max(q.z, 0.0f)) << 2;
}

// Cross product of two edges: along the winding's normal, with a length of twice the area.
static olx_vec3 doubled_area(const olx_scene *scene, uint32_t triangle) {
  const olx_vec3 a = olx_scene_corner(scene, triangle, 0);
  return olx_cross(olx_sub(olx_scene_corner(scene, triangle, 1), a), olx_sub(olx_scene_corner(scene, triangle, 2), a));
}

typedef struct olx_area_point area_point;

typedef struct asker {
  const olx_space *space;
  const olx_sight *sight;
  olx_surfels *surfels;
  const uint8_t *views;
  uint32_t least, seed;
} asker;

typedef struct atlas_maker {
  asker ask;
  const area_point *points; // NULL for rays
  olx_surfel *sides;        // two per point; a ray uses the first alone
  uint8_t *present;         // per point: not in a masked-out part; per ray: it hit the tile
  uint8_t *cut_off;         // per side of a point
  uint32_t count, seed, threads;
} atlas_maker;

static olx_result order_triangles(const olx_scene *scene, morton_entry **order) {
  *order = olx_allocate(scene->triangle_count, sizeof **order);
  if (!*order) return olx_fail(OLX_ERROR_MEMORY, "place: no memory for %u triangles", scene->triangle_count);
  for (uint32_t t = 0; t < scene->triangle_count; t++) {
    const olx_vec3 sum =
        olx_add(olx_scene_corner(scene, t, 0), olx_add(olx_scene_corner(scene, t, 1), olx_scene_corner(scene, t, 2)));
    (*order)[t] = (morton_entry){morton_code(scene, olx_scale(sum, 1.0f / 3.0f)), t};
  }
  qsort(*order, scene->triangle_count, sizeof **order, compare_entries);
  return OLX_OK;
}

// Draws points at equal steps of area along the triangles in the order of the Morton curve.
static olx_result draw_points(const olx_scene *scene, olx_area_points *all) {
  morton_entry *order;
  OLX_TRY(order_triangles(scene, &order));
  double total = 0.0, reached = 0.0;
  for (uint32_t t = 0; t < scene->triangle_count; t++) total += 0.5 * (double)olx_length(doubled_area(scene, t));
  const double step = total / all->count, offset = (double)olx_unit_float(olx_hash(all->seed));
  uint32_t drawn = 0;
  for (uint32_t i = 0; i < scene->triangle_count; i++) {
    const uint32_t triangle = order[i].index;
    reached += 0.5 * (double)olx_length(doubled_area(scene, triangle));
    for (uint32_t nth = 0; drawn < all->count && (drawn + offset) * step < reached; nth++, drawn++) {
      all->items[drawn] = (area_point){triangle, nth};
    }
  }
  olx_release(order);
  all->count = drawn;
  all->metres2 = step;
  return total > 0.0 ? OLX_OK : olx_fail(OLX_ERROR_EMPTY, "nothing to see: the scene's triangles have no area");
}

static olx_vec2 point_uv(area_point at, uint32_t seed) {
  return olx_sample_triangle(olx_stratified2(at.nth, olx_hash2(seed, at.triangle)));
}

static olx_vec3 point_on(const olx_scene *scene, uint32_t triangle, olx_vec2 uv) {
  const olx_vec3 a = olx_scene_corner(scene, triangle, 0), b = olx_scene_corner(scene, triangle, 1),
                 c = olx_scene_corner(scene, triangle, 2);
  return olx_madd(olx_madd(a, olx_sub(b, a), uv.x), olx_sub(c, a), uv.y);
}

// Sorts the points by tiles; within a tile they keep their order.
static olx_result sort_points(const olx_world *world, olx_area_points *all) {
  area_point *sorted = olx_allocate(all->count, sizeof *sorted);
  uint32_t *tile_of = olx_allocate(all->count, sizeof *tile_of);
  all->first = olx_allocate_zero((size_t)world->tile_total + 2, sizeof *all->first);
  if (!sorted || !tile_of || !all->first) {
    olx_release(sorted);
    olx_release(tile_of);
    return olx_fail(OLX_ERROR_MEMORY, "place: no memory for %u surfels", all->count);
  }
  for (uint32_t i = 0; i < all->count; i++) {
    const olx_vec2 uv = point_uv(all->items[i], all->seed);
    tile_of[i] = olx_world_tile_of(world, point_on(world->scene, all->items[i].triangle, uv));
    all->first[tile_of[i] + 2]++;
  }
  for (uint32_t t = 2; t < world->tile_total + 2; t++) all->first[t] += all->first[t - 1];
  for (uint32_t i = 0; i < all->count; i++) sorted[all->first[tile_of[i] + 1]++] = all->items[i];
  olx_release(tile_of);
  olx_release(all->items);
  all->items = sorted;
  return OLX_OK;
}

olx_result olx_area_points_create(const olx_world *world, uint32_t points, uint32_t seed, olx_area_points *all) {
  *all = (olx_area_points){.items = olx_allocate(points, sizeof *all->items), .count = points, .seed = seed};
  olx_result result = OLX_ERROR_MEMORY;
  if (all->items) result = draw_points(world->scene, all);
  else olx_fail(result, "place: no memory for %u surfels", points);
  if (result == OLX_OK) result = sort_points(world, all);
  if (result != OLX_OK) olx_area_points_free(all);
  return result;
}

void olx_area_points_free(olx_area_points *all) {
  olx_release(all->items);
  olx_release(all->first);
  all->items = NULL;
  all->first = NULL;
}

// Sets up both sides of a point of a triangle.
static void set_up_sides(const atlas_maker *m, uint32_t index, uint32_t triangle, olx_vec2 uv) {
  const olx_scene *scene = m->ask.space->scene;
  const olx_vec3 a = olx_scene_corner(scene, triangle, 0), b = olx_scene_corner(scene, triangle, 1),
                 c = olx_scene_corner(scene, triangle, 2);
  const olx_vec3 p = point_on(scene, triangle, uv);
  const float epsilon = olx_surface_epsilon(scene, triangle);
  // Offsets a point away from edges, where walls meet, as the renderer does for its rays.
  const olx_vec3 way = olx_sub(olx_scale(olx_add(a, olx_add(b, c)), 1.0f / 3.0f), p);
  const olx_vec3 moved = olx_madd(p, way, olx_min(1.0f, epsilon / olx_max(olx_length(way), 1e-30f)));
  const olx_vec3 normal = olx_normalize(doubled_area(scene, triangle));
  for (uint32_t side = 0; side < 2; side++) {
    const olx_vec3 n = side ? olx_negate(normal) : normal;
    m->sides[2 * index + side] = (olx_surfel){
        .position = olx_madd(moved, n, epsilon), .normal = n, .triangle = triangle, .fate = OLX_SURFEL_UNSEEN};
  }
}

static void set_up_point(const atlas_maker *m, uint32_t index) {
  const area_point at = m->points[index];
  const olx_vec2 uv = point_uv(at, m->seed);
  m->present[index] = olx_surface_present(m->ask.space->scene, at.triangle, uv.x, uv.y);
  set_up_sides(m, index, at.triangle, uv);
}

// Draws an origin from the voxels in their order, so that origins are spread evenly.
static bool draw_start(const atlas_maker *m, uint32_t index, olx_vec3 *start) {
  const uint32_t key = olx_hash2(m->seed, index);
  const double nth = ((double)index + (double)olx_unit_float(key)) / m->count;
  return olx_space_draw(m->ask.space, (size_t)(nth * (double)m->ask.space->start_count), olx_hash(key), start);
}

// Sets up a ray from the drawn origin, in a direction of a stratified sequence.
static void set_up_ray(const atlas_maker *m, uint32_t index) {
  olx_vec3 start;
  m->sides[2 * index].fate = m->sides[2 * index + 1].fate = OLX_SURFEL_UNSEEN;
  m->present[index] = false;
  if (!draw_start(m, index, &start)) return;
  const olx_vec3 direction = olx_sample_sphere(olx_stratified2(index, m->seed));
  const olx_ray ray = {start, direction, 0.0f, INFINITY};
  const olx_ray_hit hit = olx_bvh_intersect(m->ask.space->scene->bvh, &ray);
  if (hit.triangle == OLX_NO_HIT) return;
  m->present[index] = olx_space_owns(m->ask.space, olx_madd(start, direction, hit.t));
  if (!m->present[index]) return;
  set_up_sides(m, index, hit.triangle, (olx_vec2){hit.u, hit.v});
  if (olx_dot(m->sides[2 * index].normal, direction) > 0.0f) m->sides[2 * index] = m->sides[2 * index + 1];
  m->sides[2 * index].from = start;
  m->sides[2 * index].fate = OLX_SURFEL_UNASKED;
  m->sides[2 * index + 1].fate = OLX_SURFEL_UNSEEN;
}

static olx_vec3 hemisphere_direction(olx_vec3 normal, olx_vec2 random) {
  const float phi = 2.0f * OLX_PI * random.y, r = sqrtf(olx_max(0.0f, 1.0f - random.x * random.x));
  return olx_from_basis(olx_v3(r * cosf(phi), r * sinf(phi), random.x), normal);
}

// Returns the largest distance from which a surfel is seen well at that cosine; 0 when it is grazing.
static float sight_limit(const olx_sight *sight, float cosine) {
  return cosine < sight->min_cosine ? 0.0f : sight->max_footprint * cosine / sight->texel_radians;
}

// Casts rays over the hemisphere, and stores what stops them.
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

enum { FIT = 8 };

// Returns the union of the bits of voxels along the ray: OLX_REACHABLE, OLX_ALLOWED, and FIT where a voxel allows a
// probe and sees well.
static uint8_t along_ray(const olx_space *space, const olx_sight *sight, const olx_surfel *surfel, const olx_ray *ray,
                         reach r) {
  const float limit = sight_limit(sight, olx_dot(ray->direction, surfel->normal)), step = 0.5f * space->voxels.size;
  uint8_t found = 0;
  for (float t = r.start + 0.25f * step; t < r.end && olx_march_goes_on(t, step); t += step) {
    const size_t voxel = olx_voxel_at(&space->voxels, olx_madd(ray->origin, ray->direction, t));
    if (voxel == OLX_NO_VOXEL) continue;
    found |= space->reachable[voxel] & (OLX_REACHABLE | OLX_ALLOWED);
    if (found & OLX_ALLOWED) return t <= limit ? found | FIT : found;
  }
  return found;
}

// Returns whether space that matters is within two voxels.
static bool is_near_space(const olx_space *space, olx_vec3 p) {
  for (int32_t i = 0; i < 125; i++) {
    const olx_vec3 step = {(float)(i % 5 - 2), (float)(i / 5 % 5 - 2), (float)(i / 25 - 2)};
    if (olx_space_reaches(space, olx_madd(p, step, space->voxels.size))) return true;
  }
  return false;
}

// Finds from where the surfel is seen, along lines of sight to positions spread over the space that matters; from
// nowhere when a tile has none.
static uint8_t look_from_space(const asker *a, const olx_surfel *surfel, uint32_t seed) {
  const olx_space *space = a->space;
  olx_ray rays[MOST_RAYS];
  olx_ray_hit hits[MOST_RAYS];
  if (space->place_count == 0) return 0;
  for (uint32_t i = 0; i < MOST_RAYS; i++) {
    const size_t at = (size_t)(((uint64_t)olx_hash2(seed, i) * space->place_count) >> 32);
    const olx_vec3 way = olx_sub(olx_voxel_centre(&space->voxels, space->places[at]), surfel->position);
    const bool faces = olx_dot(way, surfel->normal) > 0.0f;
    rays[i] = (olx_ray){surfel->position, olx_normalize(way), 0.0f, faces ? INFINITY : -1.0f};
  }
  olx_bvh_intersect_many(space->scene->bvh, rays, MOST_RAYS, false, hits);
  uint8_t found = 0;
  for (uint32_t i = 0; i < MOST_RAYS; i++) {
    if (rays[i].t_max > 0.0f)
      found |= along_ray(space, a->sight, surfel, &rays[i], reach_of(space, &rays[i], &hits[i]));
  }
  return found;
}

// Determines the fate of a surfel. A few rays usually suffice. The many rays of the last round are for surfels close to
// space that hardly sees them; a playable box may be far from what is seen from it.
static olx_surfel_fate find_fate(const asker *a, const olx_surfel *surfel, uint32_t seed) {
  static const uint32_t rounds[FATE_ROUNDS + 1] = {0, 8, 16, 16 + MOST_RAYS};
  olx_ray rays[MOST_RAYS];
  olx_ray_hit hits[MOST_RAYS];
  uint8_t found = 0;
  bool near = a->space->start_count > 0;
  for (uint32_t round = 0; round < FATE_ROUNDS && near; round++) {
    const uint32_t count = rounds[round + 1] - rounds[round];
    cast_around(a->space, surfel, seed, rounds[round], count, rays, hits);
    for (uint32_t i = 0; i < count; i++) {
      found |= along_ray(a->space, a->sight, surfel, &rays[i], reach_of(a->space, &rays[i], &hits[i]));
      if (found & FIT) return OLX_SURFEL_FIT;
    }
    if (round + 2 == FATE_ROUNDS) near = is_near_space(a->space, surfel->position);
  }
  if (!near && a->space->scene->probe_rules.has_playable) found |= look_from_space(a, surfel, seed);
  if (found & FIT) return OLX_SURFEL_FIT;
  return found & OLX_ALLOWED ? OLX_SURFEL_GRAZING : found & OLX_REACHABLE ? OLX_SURFEL_RESTRICTED : OLX_SURFEL_UNSEEN;
}

// Determines the fate of a surfel as far as the ray that found it decides it.
static void ask_ray(const asker *a, olx_surfel *surfel) {
  const bool allowed = olx_space_allows(a->space, surfel->from);
  if (allowed && olx_sight_quality(a->sight, surfel->from, surfel)) surfel->fate = OLX_SURFEL_FIT;
  else if (allowed) surfel->fate = OLX_SURFEL_GRAZING;
  else if (surfel->fate == OLX_SURFEL_UNSEEN) surfel->fate = OLX_SURFEL_RESTRICTED;
}

static void ask_job(void *user, uint32_t index) {
  const asker *a = user;
  const uint32_t first = index * POINTS_A_JOB;
  for (uint32_t i = first; i < first + POINTS_A_JOB && i < a->surfels->count; i++) {
    olx_surfel *surfel = &a->surfels->items[i];
    if (surfel->fate != OLX_SURFEL_UNASKED) continue;
    const bool known = a->views && a->views[i] >= a->least;
    surfel->fate = known ? OLX_SURFEL_FIT : find_fate(a, surfel, olx_hash2(a->seed, i));
    if (surfel->fate != OLX_SURFEL_FIT) ask_ray(a, surfel);
  }
}

olx_result olx_surfels_ask(const olx_space *space, const olx_sight *sight, const uint8_t *views, uint32_t least,
                           uint32_t seed, uint32_t threads, olx_surfels *surfels) {
  asker a = {space, sight, surfels, views, least, olx_hash(seed)};
  return olx_parallel_for((surfels->count + POINTS_A_JOB - 1) / POINTS_A_JOB, threads, ask_job, &a, NULL, 0);
}

// Returns whether an unseen side sees a voxel within two of it that is free, but cut off from the space that matters.
static bool faces_cut_off(const olx_space *space, const olx_surfel *surfel) {
  const olx_world *w = space->world;
  for (int32_t i = 0; i < 125; i++) {
    const olx_vec3 step = {(float)(i % 5 - 2), (float)(i / 5 % 5 - 2), (float)(i / 25 - 2)};
    uint32_t voxel[3];
    if (!olx_world_at(w, olx_madd(surfel->position, step, w->lattice.size), voxel)) continue;
    if (olx_world_state(w, voxel) != OLX_VOXEL_CUT_OFF) continue;
    const olx_ray ray = {surfel->position, olx_sub(olx_world_centre(w, voxel), surfel->position), 0.0f, 1.0f};
    if (olx_dot(ray.direction, surfel->normal) > 0.0f && !olx_bvh_occluded(space->scene->bvh, &ray)) return true;
  }
  return false;
}

static void side_job(const atlas_maker *m, uint32_t index, uint32_t side) {
  olx_surfel *surfel = &m->sides[2 * index + side];
  surfel->fate = find_fate(&m->ask, surfel, olx_hash3(m->seed, index, side));
  m->cut_off[2 * index + side] = surfel->fate == OLX_SURFEL_UNSEEN && faces_cut_off(m->ask.space, surfel);
}

static void point_job(void *user, uint32_t index) {
  const atlas_maker *m = user;
  const uint32_t first = index * POINTS_A_JOB;
  for (uint32_t i = first; i < first + POINTS_A_JOB && i < m->count; i++) {
    if (!m->points) {
      set_up_ray(m, i);
      continue;
    }
    set_up_point(m, i);
    for (uint32_t side = 0; m->present[i] && side < 2; side++) side_job(m, i, side);
  }
}

static olx_result collect_cut_off(const atlas_maker *m, olx_surfels *surfels) {
  for (uint32_t i = 0; i < 2 * m->count; i++) surfels->cut_off_count += m->cut_off[i];
  surfels->cut_off = olx_allocate(surfels->cut_off_count, sizeof *surfels->cut_off);
  if (!surfels->cut_off) return olx_fail(OLX_ERROR_MEMORY, "place: no memory for %u surfels", surfels->cut_off_count);
  for (uint32_t i = 0, used = 0; i < 2 * m->count; i++) {
    if (m->cut_off[i]) surfels->cut_off[used++] = m->sides[i].position;
  }
  return OLX_OK;
}

// Collects the sides that are seen, along the Morton curve.
static olx_result collect(const atlas_maker *m, olx_surfels *surfels) {
  const olx_scene *scene = m->ask.space->scene;
  for (uint32_t i = 0; i < m->count; i++) {
    const bool first = m->sides[2 * i].fate != OLX_SURFEL_UNSEEN,
               second = m->sides[2 * i + 1].fate != OLX_SURFEL_UNSEEN;
    surfels->present += m->present[i];
    surfels->unseen += m->present[i] && !first && !second;
    surfels->count += (uint32_t)first + (uint32_t)second;
  }
  surfels->share = surfels->count ? 1.0 / surfels->count : 0.0;
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
  return m->points ? collect_cut_off(m, surfels) : OLX_OK;
}

static olx_result make_atlas(atlas_maker *m, olx_surfels *surfels) {
  *surfels = (olx_surfels){0};
  m->sides = olx_allocate(2 * (size_t)m->count, sizeof *m->sides);
  m->present = olx_allocate(m->count, 1);
  m->cut_off = olx_allocate_zero(2 * (size_t)m->count, 1);
  const uint32_t jobs = (m->count + POINTS_A_JOB - 1) / POINTS_A_JOB;
  olx_result result = OLX_ERROR_MEMORY;
  if (m->sides && m->present && m->cut_off) result = olx_parallel_for(jobs, m->threads, point_job, m, NULL, 0);
  else olx_fail(result, "place: no memory for %u surfels", m->count);
  if (result == OLX_OK) result = collect(m, surfels);
  olx_release(m->sides);
  olx_release(m->present);
  olx_release(m->cut_off);
  if (result != OLX_OK) olx_surfels_free(surfels);
  return result;
}

olx_result olx_area_surfels(const olx_space *space, const olx_sight *sight, const olx_area_points *all,
                            uint32_t threads, olx_surfels *surfels) {
  const uint32_t *first = &all->first[space->tile.index];
  atlas_maker m = {.ask = {.space = space, .sight = sight},
                   .points = all->items + first[0],
                   .count = first[1] - first[0],
                   .seed = all->seed,
                   .threads = threads};
  return make_atlas(&m, surfels);
}

olx_result olx_surfels_create(const olx_space *space, const olx_sight *sight, olx_spread spread, uint32_t points,
                              uint32_t seed, uint32_t threads, olx_surfels *surfels) {
  if (spread == OLX_SPREAD_RAYS) {
    atlas_maker m = {.ask = {.space = space, .sight = sight}, .count = points, .seed = seed, .threads = threads};
    return make_atlas(&m, surfels);
  }
  olx_area_points all;
  *surfels = (olx_surfels){0};
  OLX_TRY(olx_area_points_create(space->world, points, seed, &all));
  const olx_result result = olx_area_surfels(space, sight, &all, threads, surfels);
  olx_area_points_free(&all);
  return result;
}

void olx_surfels_free(olx_surfels *surfels) {
  olx_release(surfels->items);
  olx_release(surfels->cut_off);
  surfels->items = NULL;
  surfels->cut_off = NULL;
  surfels->count = surfels->cut_off_count = 0;
}

// Picks one of the fit positions along the ray, each with equal probability.
static bool pick_place(const olx_space *space, const olx_sight *sight, const olx_surfel *surfel, const olx_ray *ray,
                       reach r, uint32_t seed, olx_vec3 *place) {
  const float limit = olx_min(r.end, sight_limit(sight, olx_dot(ray->direction, surfel->normal)));
  const float step = 0.5f * space->voxels.size;
  uint32_t fit = 0;
  for (float t = r.start + 0.25f * step; t < limit && olx_march_goes_on(t, step); t += step) {
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
