// Captures the geometry that a light field probe sees, by a ray through the middle of each texel, and casts the rays
// through the parts of texels by which their surfaces are sampled.
#include "bake/capture/capture.h"

#include "core/hooks.h"
#include "core/octahedral.h"
#include "core/pack.h"
#include "core/result.h"
#include "scene/bvh.h"
#include "scene/environment.h"
#include "scene/texel_samples.h"

enum { PACKET = 64 };

// Returns the normal of a triangle, on the side that a ray comes from.
static olx_vec3 facing_normal(const olx_scene *scene, uint32_t triangle, olx_vec3 direction) {
  const uint32_t *corner = scene->indices + 3 * (size_t)triangle;
  const olx_vec3 a = scene->positions[corner[0]], b = scene->positions[corner[1]], p = scene->positions[corner[2]];
  const olx_vec3 n = olx_normalize(olx_cross(olx_sub(b, a), olx_sub(p, a)));
  return olx_dot(n, direction) > 0.0f ? olx_negate(n) : n;
}

olx_geometry_texel olx_capture_geometry(const void *capture, uint32_t x, uint32_t y) {
  const olx_capture *c = capture;
  const olx_ray_hit *hit = &c->hits[(size_t)y * c->size + x];
  if (hit->triangle == OLX_NO_HIT) return (olx_geometry_texel){.distance = INFINITY};
  return (olx_geometry_texel){hit->t,
                              facing_normal(c->context->scene, hit->triangle, olx_texel_direction(x, y, c->size))};
}

static bool emits_towards(const olx_scene *scene, const olx_ray_hit *hit, olx_vec3 direction) {
  if (!olx_hit_emits(scene, hit)) return false;
  return olx_max3(olx_surface_at(scene, hit, direction).emission) > 0.0f;
}

// Stores the distance, with the flag of emitters, and the normal of a texel.
static void store_geometry(const olx_capture *c, uint32_t texel, const olx_ray_hit *hit, olx_vec3 direction) {
  c->hits[texel] = *hit;
  if (hit->triangle == OLX_NO_HIT) {
    c->distance[texel] = olx_half_pack(INFINITY);
    c->normal[texel] = olx_normal_pack(olx_negate(direction));
    return;
  }
  // A probe sees only one side of a triangle.
  const bool repeats = texel % c->size > 0 && c->hits[texel - 1].triangle == hit->triangle;
  c->normal[texel] =
      repeats ? c->normal[texel - 1] : olx_normal_pack(facing_normal(c->context->scene, hit->triangle, direction));
  const uint16_t mark = emits_towards(c->context->scene, hit, direction) ? 0x8000u : 0;
  c->distance[texel] = (uint16_t)(olx_half_pack(hit->t / c->context->distance_scale) | mark);
}

// Finds what rays from the probe hit: in its rasterised cube where there is one, or else by casting them.
static void find_hits(olx_capture *c, const olx_ray *rays, uint32_t count, olx_ray_hit *hits) {
  const olx_scene *scene = c->context->scene;
  if (!c->cubes.raster) {
    olx_bvh_intersect_many(scene->bvh, rays, count, true, hits);
    return;
  }
  const uint32_t cast = olx_cube_views_intersect(&c->cubes, scene, c->probe, rays, count, hits);
  if (cast) atomic_fetch_add_explicit(&c->recast, cast, memory_order_relaxed);
}

static void capture_row(void *user, uint32_t y) {
  olx_capture *c = user;
  const uint32_t packet = c->size < PACKET ? c->size : PACKET;
  olx_ray rays[PACKET];
  olx_ray_hit hits[PACKET];
  for (uint32_t first = 0; first < c->size; first += packet) {
    for (uint32_t i = 0; i < packet; i++) {
      rays[i] = (olx_ray){c->position, olx_texel_direction(first + i, y, c->size), 0.0f, INFINITY};
    }
    find_hits(c, rays, packet, hits);
    for (uint32_t i = 0; i < packet; i++) store_geometry(c, y * c->size + first + i, &hits[i], rays[i].direction);
  }
}

olx_result olx_capture_probe(olx_capture *c, uint32_t probe, olx_vec3 position) {
  c->probe = probe;
  c->position = position;
  c->rays += (uint64_t)c->size * c->size;
  OLX_TRY(olx_cube_views_look(&c->cubes, c->context, probe));
  return olx_bake_for(c->context, c->size, capture_row, c, 0);
}

static uint32_t make_samples(const olx_capture *c, uint32_t x, uint32_t y, olx_ray rays[OLX_CAPTURE_MOST_RAYS]) {
  const uint32_t side = c->context->settings->samples;
  uint32_t count = 0;
  for (uint32_t i = 0; i < OLX_CAPTURE_CHUNK; i++) {
    for (uint32_t k = 0; k < side * side; k++) {
      const olx_vec3 direction = olx_texel_sample_direction(x + i, y, c->size, side, k);
      rays[count++] = (olx_ray){c->position, direction, 0.0f, INFINITY};
    }
  }
  return count;
}

uint32_t olx_capture_cast_samples(olx_capture *c, uint32_t x, uint32_t y, olx_ray rays[OLX_CAPTURE_MOST_RAYS],
                                  olx_ray_hit hits[OLX_CAPTURE_MOST_RAYS]) {
  const uint32_t count = make_samples(c, x, y, rays);
  find_hits(c, rays, count, hits);
  return count;
}

static void measure_row(void *user, uint32_t y) {
  const olx_capture *c = user;
  olx_ray rays[OLX_CAPTURE_MOST_RAYS];
  olx_ray_hit hits[OLX_CAPTURE_MOST_RAYS];
  c->row_seconds[y] = 0.0;
  for (uint32_t x = 0; x < c->size; x += OLX_CAPTURE_CHUNK) {
    const uint32_t count = make_samples(c, x, y, rays);
    const double start = olx_seconds();
    olx_bvh_intersect_many(c->context->scene->bvh, rays, count, true, hits);
    c->row_seconds[y] += olx_seconds() - start;
  }
}

olx_result olx_capture_measure(olx_capture *c, double *embree_seconds) {
  OLX_TRY(olx_bake_for(c->context, c->size, measure_row, c, 0));
  const uint32_t threads = c->context->settings->threads, wanted = threads ? threads : olx_processor_count();
  double sum = 0.0;
  for (uint32_t y = 0; y < c->size; y++) sum += c->row_seconds[y];
  *embree_seconds += sum / (wanted < c->size ? wanted : c->size);
  return OLX_OK;
}

uint64_t olx_capture_bytes(uint32_t size) {
  const olx_capture *c = NULL;
  return (uint64_t)size * size * (sizeof *c->normal + sizeof *c->distance + sizeof *c->hits);
}

olx_result olx_capture_create(olx_capture *c) {
  const size_t texels = (size_t)c->size * c->size;
  c->normal = olx_allocate(texels, sizeof *c->normal);
  c->distance = olx_allocate(texels, sizeof *c->distance);
  c->hits = olx_allocate(texels, sizeof *c->hits);
  c->row_seconds = olx_allocate(c->size, sizeof *c->row_seconds);
  if (c->normal && c->distance && c->hits && c->row_seconds)
    return olx_cube_views_create(c->context->settings, c->size, &c->cubes);
  olx_capture_free(c);
  return olx_fail(OLX_ERROR_MEMORY, "bake: out of memory for maps of %u x %u texels", c->size, c->size);
}

void olx_capture_free(olx_capture *c) {
  olx_release(c->normal);
  olx_release(c->distance);
  olx_release(c->hits);
  olx_release(c->row_seconds);
  olx_cube_views_free(&c->cubes);
  c->normal = c->distance = NULL;
  c->hits = NULL;
  c->row_seconds = NULL;
}

uint64_t olx_capture_units(const olx_capture *c) {
  const uint64_t samples = c->context->settings->samples;
  return (uint64_t)c->size * c->size * samples * samples;
}
