#include "bake/relight_bake.h"

#include "bake/arrays.h"
#include "core/hooks.h"
#include "core/pack.h"
#include "core/result.h"
#include "select/cage.h"

enum {
  PACKET = 128,
  PROBE_RAYS = OLX_FIT_POINTS_PER_PROBE * OLX_RELIGHT_RAYS,
  SURFACES_A_HIDDEN = 4, // so many surfaces that a probe sees go with a place for one that none sees
  HIDDEN_PLACES = 1024   // at most
};

// A surface takes this share of a map of n x n directions, along a side: the root of 4 pi.
static const float VIEW_SIDE = 3.5449077f;

uint32_t olx_relight_surface_size(uint32_t irradiance_size) {
  return irradiance_size < 16 ? 16 : irradiance_size > 128 ? 128 : irradiance_size;
}

uint32_t olx_relight_hidden(uint32_t surface_size) {
  const uint32_t places = surface_size * surface_size / SURFACES_A_HIDDEN;
  return places < HIDDEN_PLACES ? places : HIDDEN_PLACES;
}

// Surfaces reflect here as they do on average over views, because they will be looked at from elsewhere.
static olx_vec3 matte_albedo(const olx_surface *surface) {
  return olx_min_each(olx_bsdf_matte(&surface->bsdf).albedo, olx_splat(1.0f));
}

static void see_surfaces(void *user, uint32_t row) {
  const olx_relight_bake *b = user;
  const uint32_t size = b->size, probe = row / size, y = row % size;
  olx_ray rays[PACKET] = {0};
  olx_ray_hit hits[PACKET];
  for (uint32_t x = 0; x < size; x++) {
    rays[x] = (olx_ray){b->positions[probe], olx_surface_direction(x, y, size), 0.0f, INFINITY};
  }
  olx_bvh_intersect_many(b->scene->bvh, rays, size, true, hits);
  olx_surface_sample *samples = b->surfaces + (size_t)row * size;
  for (uint32_t x = 0; x < size; x++) {
    const olx_vec3 direction = rays[x].direction;
    if (hits[x].triangle == OLX_NO_HIT) {
      samples[x] = (olx_surface_sample){0, olx_normal_pack(olx_negate(direction)), olx_half_pack(INFINITY)};
      continue;
    }
    const olx_surface surface = olx_surface_at(b->scene, &hits[x], direction);
    samples[x] =
        (olx_surface_sample){olx_r11g11b10f_pack(matte_albedo(&surface)), olx_normal_pack(surface.shading_normal),
                             olx_half_pack(hits[x].t / b->distance_scale)};
  }
}

static olx_vec3 surface_place(const olx_relight_bake *b, uint32_t probe, uint32_t i, const olx_surface_sample *s) {
  const olx_vec3 direction = olx_surface_direction(i % b->size, i / b->size, b->size);
  return olx_madd(b->positions[probe], direction, olx_half_unpack(s->distance) * b->distance_scale);
}

// How far off a probe's surface in the direction of the point lies, in footprints; infinite when it is another surface.
static float mismatch(const olx_relight_bake *b, uint32_t probe, olx_vec3 point, olx_vec3 normal, uint32_t *index) {
  const olx_vec2 uv = olx_octahedral_encode(olx_sub(point, b->positions[probe]));
  const float n = (float)b->size;
  const uint32_t i = (uint32_t)olx_min(uv.y * n, n - 1.0f) * b->size + (uint32_t)olx_min(uv.x * n, n - 1.0f);
  const olx_surface_sample *s = &b->surfaces[(size_t)probe * b->size * b->size + i];
  *index = probe * b->size * b->size + i;
  if (s->distance >= 0x7C00u || olx_dot(olx_normal_unpack(s->normal), normal) < 0.8f) return INFINITY;
  const olx_vec3 away = olx_sub(point, surface_place(b, probe, i, s));
  const float footprint = olx_half_unpack(s->distance) * b->distance_scale * VIEW_SIDE / n;
  const float height = fabsf(olx_dot(away, normal));
  return height > 0.5f * footprint ? INFINITY : olx_length(away);
}

// The surface nearest to a point, of the probes in the cells around it.
static uint32_t find_surface(const olx_relight_bake *b, olx_vec3 point, olx_vec3 normal) {
  const olx_cage cage = olx_cage_at(b->grid, point);
  float least = INFINITY;
  uint32_t found = OLX_FIT_RAY_UNKNOWN;
  for (uint32_t i = 0; i < 64; i++) {
    const uint32_t offset[3] = {i & 3u, i >> 2 & 3u, i >> 4};
    uint32_t at[3], index;
    bool inside = true;
    for (uint32_t axis = 0; axis < 3; axis++) {
      at[axis] = cage.base[axis] + offset[axis] - 1u; // wraps to a huge number below 0
      inside = inside && at[axis] < b->grid->count[axis];
    }
    if (!inside) continue;
    const uint32_t probe = at[0] + b->grid->count[0] * (at[1] + b->grid->count[1] * at[2]);
    if (b->flags[probe] & OLX_PROBE_BURIED) continue;
    const float away = mismatch(b, probe, point, normal, &index);
    if (away >= least) continue;
    least = away;
    found = index;
  }
  return found;
}

// The place and the geometric normal of a hit, on the side that faces `from`.
static olx_vec3 hit_place(const olx_scene *scene, const olx_ray_hit *hit, olx_vec3 from, olx_vec3 *normal) {
  const uint32_t *corner = scene->indices + 3 * (size_t)hit->triangle;
  const olx_vec3 a = scene->positions[corner[0]], ab = olx_sub(scene->positions[corner[1]], a),
                 ac = olx_sub(scene->positions[corner[2]], a);
  const olx_vec3 place = olx_madd(olx_madd(a, ab, hit->u), ac, hit->v);
  const olx_vec3 n = olx_normalize(olx_cross(ab, ac));
  *normal = olx_dot(n, olx_sub(place, from)) > 0.0f ? olx_negate(n) : n;
  return place;
}

// Where a ray ended that no probe sees there; shadow rays may begin at the place.
static olx_ray_end ray_end(const olx_relight_bake *b, const olx_ray_hit *hit, olx_vec3 direction) {
  const olx_surface surface = olx_surface_at(b->scene, hit, direction);
  const olx_vec3 inside = olx_add(surface.position, surface.inward);
  return (olx_ray_end){olx_madd(inside, surface.geometric_normal, surface.epsilon), surface.shading_normal,
                       matte_albedo(&surface)};
}

static void find_points(void *user, uint32_t i) {
  const olx_relight_bake *b = user;
  uint32_t *words = b->fit + (size_t)i * (4 + OLX_RELIGHT_RAYS);
  uint32_t *met = b->met + (size_t)i * OLX_RELIGHT_RAYS;
  olx_vec3 position = {0}, normal = {0};
  const olx_ray_hit *hits;
  const bool valid =
      olx_surface_fit_point(b->fitted, b->probe * OLX_FIT_POINTS_PER_PROBE + i, &position, &normal, &hits);
  const olx_fit_place at = {valid ? position : olx_splat(0.0f), valid ? olx_normal_pack(normal) : OLX_FIT_NO_POINT};
  memcpy(words, &at, sizeof at);
  for (uint32_t k = 0; k < OLX_RELIGHT_RAYS; k++) {
    met[k] = OLX_FIT_RAY_SKY;
    if (!valid || hits[k].triangle == OLX_NO_HIT) continue;
    olx_vec3 facing;
    const olx_vec3 place = hit_place(b->scene, &hits[k], position, &facing);
    met[k] = find_surface(b, place, facing);
    if (met[k] != OLX_FIT_RAY_UNKNOWN) continue;
    b->ends[(size_t)i * OLX_RELIGHT_RAYS + k] = ray_end(b, &hits[k], olx_normalize(olx_sub(place, position)));
  }
}

// The points of a probe, their rays and what is hidden there.
static olx_result find_fit(olx_relight_bake *b) {
  OLX_TRY(olx_parallel_for(OLX_FIT_POINTS_PER_PROBE, b->threads, find_points, b, b->task, 0));
  const uint32_t most = olx_relight_hidden(b->size);
  const olx_hidden_input input = {.ends = b->ends,
                                  .rays = b->met,
                                  .count = PROBE_RAYS,
                                  .probe = b->positions[b->probe],
                                  .angle = VIEW_SIDE / (float)b->size,
                                  .least_length = 1e-6f * b->distance_scale,
                                  .first = b->probe_count * b->size * b->size + b->probe * most,
                                  .most = most};
  if (!olx_hidden_merge(&input, b->hidden)) return olx_fail(OLX_ERROR_MEMORY, "bake: out of memory for surfaces");
  for (uint32_t i = 0; i < OLX_FIT_POINTS_PER_PROBE; i++) {
    memcpy(b->fit + (size_t)i * (4 + OLX_RELIGHT_RAYS) + 4, b->met + (size_t)i * OLX_RELIGHT_RAYS,
           OLX_RELIGHT_RAYS * sizeof *b->met);
  }
  return OLX_OK;
}

static uint32_t list_arrays(olx_relight_bake *b, olx_array_row rows[6]) {
  const uint64_t surfaces = (uint64_t)b->size * b->size, texels = (uint64_t)b->radiance_size * b->radiance_size;
  rows[0] = (olx_array_row){&b->surfaces, b->probe_count * surfaces, sizeof *b->surfaces, false};
  rows[1] =
      (olx_array_row){&b->fit, (uint64_t)OLX_FIT_POINTS_PER_PROBE * (4 + OLX_RELIGHT_RAYS), sizeof *b->fit, false};
  rows[2] = (olx_array_row){&b->met, PROBE_RAYS, sizeof *b->met, false};
  rows[3] = (olx_array_row){&b->ends, PROBE_RAYS, sizeof *b->ends, false};
  rows[4] = (olx_array_row){&b->hidden, olx_relight_hidden(b->size), sizeof *b->hidden, false};
  rows[5] = (olx_array_row){&b->albedo, texels, sizeof *b->albedo, false};
  return 6;
}

uint64_t olx_relight_bake_bytes(const olx_relight_bake *b) {
  olx_relight_bake unmade = *b;
  olx_array_row rows[6];
  return olx_arrays_bytes(rows, list_arrays(&unmade, rows));
}

olx_result olx_relight_bake_create(olx_relight_bake *b) {
  const size_t surfaces = (size_t)b->size * b->size;
  olx_array_row rows[6];
  if (!olx_arrays_allocate(rows, list_arrays(b, rows))) {
    return olx_fail(OLX_ERROR_MEMORY, "bake: out of memory for surfaces");
  }
  b->rays += b->probe_count * surfaces;
  return olx_parallel_for(b->probe_count * b->size, b->threads, see_surfaces, b, b->task, 0);
}

void olx_relight_bake_free(olx_relight_bake *b) {
  olx_release(b->surfaces);
  olx_release(b->fit);
  olx_release(b->met);
  olx_release(b->ends);
  olx_release(b->hidden);
  olx_release(b->albedo);
  *b = (olx_relight_bake){0};
}

olx_result olx_relight_bake_write(olx_relight_bake *b, const olx_surface_fit *fit, olx_field_writer *writer) {
  b->fitted = fit;
  for (b->probe = 0; b->probe < b->probe_count; b->probe++) {
    if (fit) OLX_TRY(find_fit(b));
    const olx_relight_record record = {b->surfaces + (size_t)b->probe * b->size * b->size, fit ? b->fit : NULL,
                                       fit ? b->hidden : NULL};
    OLX_TRY(olx_field_writer_relight(writer, b->probe, &record));
  }
  return OLX_OK;
}

// The mean albedo of what samples^2 rays through a texel meet.
static void see_albedo(void *user, uint32_t y) {
  const olx_relight_bake *b = user;
  const uint32_t n = b->radiance_size, side = b->samples, count = side * side;
  const float step = 1.0f / (float)(n * side);
  olx_ray rays[PACKET] = {0};
  olx_ray_hit hits[PACKET];
  for (uint32_t x = 0; x < n; x++) {
    for (uint32_t k = 0; k < count; k++) {
      const olx_vec2 uv = {((float)(x * side + k % side) + 0.5078125f) * step,
                           ((float)(y * side + k / side) + 0.48828125f) * step};
      rays[k] = (olx_ray){b->position, olx_octahedral_decode(uv), 0.0f, INFINITY};
    }
    olx_bvh_intersect_many(b->scene->bvh, rays, count, true, hits);
    olx_vec3 sum = {0};
    float met = 0.0f;
    for (uint32_t k = 0; k < count; k++) {
      if (hits[k].triangle == OLX_NO_HIT) continue;
      const olx_surface surface = olx_surface_at(b->scene, &hits[k], rays[k].direction);
      sum = olx_add(sum, matte_albedo(&surface));
      met += 1.0f;
    }
    b->albedo[y * n + x] = olx_r11g11b10f_pack(olx_scale(sum, 1.0f / olx_max(met, 1.0f)));
  }
}

olx_result olx_relight_bake_albedo(olx_relight_bake *b, olx_vec3 position) {
  b->position = position;
  b->rays += (uint64_t)b->radiance_size * b->radiance_size * b->samples * b->samples;
  return olx_parallel_for(b->radiance_size, b->threads, see_albedo, b, b->task, 0);
}
