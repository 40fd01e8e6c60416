#include "render/field_renderer.h"

#include "core/parallel.h"
#include "render/direct_light.h"

// Seeds of the passes' random numbers, apart from those of direct light.
enum { DIFFUSE_BRANCH = 2, GLOSSY_BRANCH = 3 };

typedef struct shaded_tile {
  const olx_render_context *context;
  olx_tile_rays *rays;
  olx_camera_sample *samples;
  olx_render_stats *stats;
  uint32_t count;
  uint32_t pixel[OLX_TILE_PIXELS]; // in the tile, of those that hit something
  olx_surface surfaces[OLX_TILE_PIXELS];
  olx_shading shadings[OLX_TILE_PIXELS];
} shaded_tile;

static void find_surfaces(shaded_tile *tile) {
  tile->count = 0;
  for (uint32_t i = 0; i < tile->rays->count; i++) {
    if (tile->rays->hits[i].triangle == OLX_NO_HIT) continue;
    const uint32_t k = tile->count++;
    tile->pixel[k] = i;
    tile->surfaces[k] = olx_surface_at(tile->context->scene, &tile->rays->hits[i], tile->rays->directions[i]);
    tile->shadings[k] = olx_shading_make(&tile->surfaces[k], tile->rays->directions[i]);
    olx_camera_sample *sample = &tile->samples[i];
    sample->emission = tile->surfaces[k].emission;
    sample->albedo = tile->surfaces[k].bsdf.albedo;
    sample->normal = tile->surfaces[k].shading_normal;
  }
}

static void light_directly(shaded_tile *tile) {
  const bool emitters_traced = tile->context->settings->sample.emitters;
  for (uint32_t k = 0; k < tile->count; k++) {
    const uint32_t i = tile->pixel[k];
    olx_sampler *sampler = &tile->rays->samplers[i];
    const olx_scene *scene = tile->context->scene;
    const olx_lobes lit = emitters_traced ? olx_direct_light_sampled(scene, &tile->shadings[k], OLX_MIS_DELTA_ONLY,
                                                                     sampler, &tile->stats->rays)
                                          : olx_direct_light(scene, &tile->shadings[k], sampler, &tile->stats->rays);
    tile->samples[i].direct = olx_add(lit.diffuse, lit.specular);
  }
}

static olx_vec3 field_origin(const olx_surface *surface) {
  return olx_madd(surface->position, surface->geometric_normal, surface->epsilon);
}

static void count_ray(olx_render_stats *stats, const olx_trace_hit *hit) {
  stats->field_rays++;
  stats->field_unresolved += hit->status == OLX_TRACE_UNKNOWN;
  stats->field_steps += hit->texel_steps;
  stats->field_probes += hit->probes_tried;
}

// Irradiance by cosine rays through the field.
static olx_vec3 traced_irradiance(const shaded_tile *tile, uint32_t k) {
  const olx_render_settings *settings = tile->context->settings;
  const olx_surface *surface = &tile->surfaces[k];
  const olx_sampler *sampler = &tile->rays->samplers[tile->pixel[k]];
  const uint32_t count = settings->diffuse_samples, seed = olx_sampler_split(sampler, DIFFUSE_BRANCH).seed;
  const olx_vec3 origin = field_origin(surface);
  olx_vec3 sum = {0};
  for (uint32_t j = 0; j < count; j++) {
    const olx_vec3 local = olx_sample_cosine(olx_stratified2(sampler->index * count + j, seed));
    const olx_vec3 direction = olx_from_basis(local, tile->shadings[k].normal);
    if (olx_dot(direction, surface->geometric_normal) <= 0.0f) continue;
    const olx_trace_hit hit = olx_trace(tile->context->field, &settings->sample, origin, direction, INFINITY);
    count_ray(tile->stats, &hit);
    if (!hit.emitter || settings->sample.emitters) sum = olx_add(sum, hit.radiance);
  }
  return olx_scale(sum, OLX_PI / (float)count);
}

static void light_diffusely(shaded_tile *tile) {
  const olx_render_settings *settings = tile->context->settings;
  for (uint32_t k = 0; k < tile->count; k++) {
    const olx_shading *shading = &tile->shadings[k];
    if (!shading->has_diffuse) continue;
    const uint32_t i = tile->pixel[k];
    const olx_vec3 irradiance =
        settings->diffuse == OLX_DIFFUSE_TRACED
            ? traced_irradiance(tile, k)
            : olx_irradiance(tile->context->field, &settings->sample, field_origin(shading->surface), shading->normal,
                             olx_negate(tile->rays->directions[i]));
    tile->samples[i].indirect_diffuse = olx_scale(olx_mul(shading->diffuse, irradiance), 1.0f / OLX_PI);
  }
}

static void light_glossily(shaded_tile *tile) {
  const olx_render_settings *settings = tile->context->settings;
  for (uint32_t k = 0; k < tile->count; k++) {
    const olx_shading *shading = &tile->shadings[k];
    if (!shading->has_specular) continue;
    const uint32_t i = tile->pixel[k];
    const olx_surface *surface = shading->surface;
    const olx_sampler *sampler = &tile->rays->samplers[i];
    const uint32_t count = surface->bsdf.alpha > 0.0f ? settings->glossy_samples : 1;
    const uint32_t seed = olx_sampler_split(sampler, GLOSSY_BRANCH).seed;
    const olx_vec3 origin = field_origin(surface), view = olx_negate(tile->rays->directions[i]);
    olx_vec3 sum = {0};
    for (uint32_t j = 0; j < count; j++) {
      const olx_vec2 random = olx_stratified2(sampler->index * count + j, seed);
      float weight, half_cosine;
      olx_trace_hit hit;
      const olx_vec3 radiance = olx_glossy(tile->context->field, &settings->sample, origin, shading->normal, view,
                                           surface->roughness, random, &weight, &half_cosine, &hit);
      if (weight <= 0.0f) continue;
      count_ray(tile->stats, &hit);
      const olx_vec3 fresnel = olx_fresnel(&surface->bsdf, half_cosine);
      sum = olx_add(sum, olx_scale(olx_mul(fresnel, radiance), weight));
    }
    tile->samples[i].indirect_glossy = olx_scale(sum, 1.0f / (float)count);
  }
}

void olx_field_render_tile(const olx_render_context *context, olx_tile_rays *rays, olx_camera_sample *samples,
                           olx_render_stats *stats) {
  shaded_tile tile = {.context = context, .rays = rays, .samples = samples, .stats = stats};
  const double start = olx_thread_seconds();
  find_surfaces(&tile);
  const double found = olx_thread_seconds();
  light_directly(&tile);
  const double direct = olx_thread_seconds();
  light_diffusely(&tile);
  const double diffuse = olx_thread_seconds();
  light_glossily(&tile);
  stats->primary_seconds += found - start;
  stats->direct_seconds += direct - found;
  stats->diffuse_seconds += diffuse - direct;
  stats->glossy_seconds += olx_thread_seconds() - diffuse;
}
