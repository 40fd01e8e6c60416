// Casts coarse maps of distance and normal around every probe, from which the builders of selectors quickly determine
// which probe sees which point.
#include "bake/selectors/probe_views.h"

#include "core/hooks.h"
#include "core/morton.h"
#include "core/pack.h"
#include "core/result.h"
#include "scene/bvh.h"

enum { TILE_SIDE = 8, TILE_TEXELS = TILE_SIDE * TILE_SIDE, LARGEST_MAP = 128, MOST_TEXELS = 1 << 25 };

// Cosines of incidence are clamped to at least this.
static const float LEAST_COSINE = 0.1f;

static uint32_t map_size(const olx_selector_input *input) {
  uint32_t n = input->radiance_size < LARGEST_MAP ? input->radiance_size : LARGEST_MAP;
  while (n > 8 && (uint64_t)n * n * input->count > MOST_TEXELS) n /= 2;
  return n;
}

static uint16_t facing_normal(const olx_scene *scene, uint32_t triangle, olx_vec3 direction) {
  const uint32_t *corner = scene->indices + 3 * (size_t)triangle;
  const olx_vec3 a = scene->positions[corner[0]], b = scene->positions[corner[1]], c = scene->positions[corner[2]];
  const olx_vec3 n = olx_normalize(olx_cross(olx_sub(b, a), olx_sub(c, a)));
  return olx_normal_pack(olx_dot(n, direction) > 0.0f ? olx_negate(n) : n);
}

static void cast_tile(const olx_probe_views *views, uint32_t probe, uint32_t first_x, uint32_t first_y) {
  const olx_selector_input *input = views->input;
  const size_t map = (size_t)probe * views->n * views->n;
  olx_ray rays[TILE_TEXELS];
  olx_ray_hit hits[TILE_TEXELS];
  size_t texels[TILE_TEXELS];
  for (uint32_t i = 0; i < TILE_TEXELS; i++) {
    const uint32_t x = first_x + olx_morton_coordinate(i), y = first_y + olx_morton_coordinate(i >> 1);
    texels[i] = map + (size_t)y * views->n + x;
    rays[i] = (olx_ray){input->positions[probe], olx_texel_direction(x, y, views->n), 0.0f, INFINITY};
  }
  olx_bvh_intersect_many(input->scene->bvh, rays, TILE_TEXELS, true, hits);
  for (uint32_t i = 0; i < TILE_TEXELS; i++) {
    const bool sky = hits[i].triangle == OLX_NO_HIT;
    views->distance[texels[i]] = sky ? INFINITY : hits[i].t;
    views->normal[texels[i]] = sky ? 0 : facing_normal(input->scene, hits[i].triangle, rays[i].direction);
  }
}

static void cast_probe(void *user, uint32_t probe) {
  const olx_probe_views *views = user;
  for (uint32_t y = 0; y < views->n; y += TILE_SIDE) {
    for (uint32_t x = 0; x < views->n; x += TILE_SIDE) cast_tile(views, probe, x, y);
  }
}

olx_result olx_probe_views_create(const olx_selector_input *input, olx_probe_views *views) {
  *views = (olx_probe_views){.input = input, .n = map_size(input)};
  const size_t texels = (size_t)views->n * views->n * input->count;
  views->distance = olx_allocate(texels, sizeof *views->distance);
  views->normal = olx_allocate(texels, sizeof *views->normal);
  if (!views->distance || !views->normal) {
    return olx_fail(OLX_ERROR_MEMORY, "bake: out of memory for the views of %u probes", input->count);
  }
  return olx_parallel_for(input->count, input->threads, cast_probe, views, input->task, 0);
}

void olx_probe_views_free(olx_probe_views *views) {
  olx_release(views->distance);
  olx_release(views->normal);
  views->distance = NULL;
  views->normal = NULL;
}

bool olx_view_sees(const olx_probe_views *views, uint32_t probe, olx_vec3 point) {
  const olx_vec3 offset = olx_sub(point, views->input->positions[probe]);
  const float n = (float)views->n, radius = olx_length(offset);
  const olx_vec2 uv = olx_octahedral_encode(offset);
  const float x = floorf(olx_clamp(uv.x * n, 0.0f, n - 1.0f)), y = floorf(olx_clamp(uv.y * n, 0.0f, n - 1.0f));
  const size_t texel = ((size_t)probe * views->n + (size_t)y) * views->n + (size_t)x;
  const float distance = views->distance[texel];
  if (distance == INFINITY) return true;
  const float footprint = distance * sqrtf(olx_texel_solid_angle_near(uv, views->n));
  const float near = 2.0f * footprint;
  if (radius < distance - near / LEAST_COSINE) return true;
  if (radius > distance + near / LEAST_COSINE) return false;
  const olx_vec3 centre = olx_octahedral_decode((olx_vec2){(x + 0.5f) / n, (y + 0.5f) / n});
  const olx_vec3 normal = olx_normal_unpack(views->normal[texel]);
  if (radius < distance - near / olx_max(-olx_dot(normal, centre), LEAST_COSINE)) return true;
  return olx_dot(normal, olx_madd(offset, centre, -distance)) >= -footprint;
}
