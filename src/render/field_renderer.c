#include "render/field_renderer.h"

#include "core/parallel.h"
#include "shade/emission.h"

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

olx_vec3 olx_field_direct(const olx_render_context *context, const olx_shading *shading, olx_sampler *sampler,
                          olx_render_stats *stats) {
  const olx_lobes lit =
      context->settings->sample.emitters
          ? olx_direct_light_sampled(context->scene, shading, OLX_MIS_DELTA_ONLY, sampler, &stats->rays)
          : olx_direct_light(context->scene, shading, sampler, &stats->rays);
  return olx_add(lit.diffuse, lit.specular);
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

olx_field_light olx_field_diffuse_ray(const olx_render_context *context, const olx_shading *shading, olx_vec2 random,
                                      olx_render_stats *stats) {
  const olx_surface *surface = shading->surface;
  const olx_vec3 direction = olx_from_basis(olx_sample_cosine(random), shading->normal);
  olx_field_light found = {.nearness = 0.0f};
  if (olx_dot(direction, surface->geometric_normal) <= 0.0f) return found;
  const olx_sample_settings *sample = &context->settings->sample;
  const olx_vec3 origin = field_origin(surface);
  const olx_trace_hit hit = olx_trace(context->field, sample, origin, direction, INFINITY);
  count_ray(stats, &hit);
  found.nearness = olx_nearness(&hit);
  if (!hit.emitter || olx_emission_counts(sample, &hit, origin)) found.light = hit.radiance;
  return found;
}

olx_field_light olx_field_glossy_ray(const olx_render_context *context, const olx_shading *shading, olx_vec3 view,
                                     olx_vec2 random, olx_render_stats *stats) {
  const olx_surface *surface = shading->surface;
  float weight, half_cosine;
  olx_trace_hit hit;
  const olx_vec3 radiance = olx_glossy(context->field, &context->settings->sample, field_origin(surface),
                                       shading->normal, view, surface->roughness, random, &weight, &half_cosine, &hit);
  if (weight <= 0.0f) return (olx_field_light){.nearness = 0.0f};
  count_ray(stats, &hit);
  if (hit.emitter && !olx_emission_counts(&context->settings->sample, &hit, field_origin(surface))) {
    return (olx_field_light){.nearness = olx_nearness(&hit)};
  }
  const olx_vec3 fresnel = olx_fresnel(&surface->bsdf, half_cosine);
  return (olx_field_light){olx_scale(olx_mul(fresnel, radiance), weight), olx_nearness(&hit)};
}

olx_vec3 olx_field_irradiance(const olx_render_context *context, const olx_shading *shading, olx_vec3 view) {
  if (context->settings->method == OLX_METHOD_CLASSIC) {
    return olx_classic_irradiance(context->field, &context->settings->sample, field_origin(shading->surface),
                                  shading->normal);
  }
  return olx_irradiance(context->field, &context->settings->sample, field_origin(shading->surface), shading->normal,
                        view);
}

bool olx_field_lobe_is_dim(const olx_render_context *context, const olx_shading *shading) {
  return olx_lobe_is_dim(&shading->surface->bsdf, shading->view.z, context->settings->dim_lobe);
}

static void light_directly(shaded_tile *tile) {
  for (uint32_t k = 0; k < tile->count; k++) {
    const uint32_t i = tile->pixel[k];
    tile->samples[i].direct =
        olx_field_direct(tile->context, &tile->shadings[k], &tile->rays->samplers[i], tile->stats);
  }
}

// Irradiance by cosine rays through the field.
static olx_vec3 traced_irradiance(const shaded_tile *tile, uint32_t k) {
  const olx_sampler *sampler = &tile->rays->samplers[tile->pixel[k]];
  const uint32_t count = tile->context->settings->diffuse_samples;
  const uint32_t seed = olx_sampler_split(sampler, OLX_DIFFUSE_BRANCH).seed;
  olx_vec3 sum = {0};
  for (uint32_t j = 0; j < count; j++) {
    const olx_vec2 random = olx_stratified2(sampler->index * count + j, seed);
    sum = olx_add(sum, olx_field_diffuse_ray(tile->context, &tile->shadings[k], random, tile->stats).light);
  }
  return olx_scale(sum, OLX_PI / (float)count);
}

static void light_diffusely(shaded_tile *tile) {
  const olx_render_settings *settings = tile->context->settings;
  const bool traced = settings->method == OLX_METHOD_FIELD && settings->diffuse == OLX_DIFFUSE_TRACED;
  for (uint32_t k = 0; k < tile->count; k++) {
    const olx_shading *shading = &tile->shadings[k];
    if (!shading->has_diffuse) continue;
    const uint32_t i = tile->pixel[k];
    const olx_vec3 view = olx_negate(tile->rays->directions[i]);
    const olx_vec3 irradiance =
        traced ? traced_irradiance(tile, k) : olx_field_irradiance(tile->context, shading, view);
    tile->samples[i].indirect_diffuse = olx_scale(olx_mul(shading->diffuse, irradiance), 1.0f / OLX_PI);
  }
}

static olx_vec3 traced_glossy(const shaded_tile *tile, uint32_t k, olx_vec3 view) {
  const olx_shading *shading = &tile->shadings[k];
  const olx_sampler *sampler = &tile->rays->samplers[tile->pixel[k]];
  const uint32_t count = shading->surface->bsdf.alpha > 0.0f ? tile->context->settings->glossy_samples : 1;
  const uint32_t seed = olx_sampler_split(sampler, OLX_GLOSSY_BRANCH).seed;
  olx_vec3 sum = {0};
  for (uint32_t j = 0; j < count; j++) {
    const olx_vec2 random = olx_stratified2(sampler->index * count + j, seed);
    sum = olx_add(sum, olx_field_glossy_ray(tile->context, shading, view, random, tile->stats).light);
  }
  return olx_scale(sum, 1.0f / (float)count);
}

static olx_vec3 classic_glossy(const shaded_tile *tile, uint32_t k, olx_vec3 view) {
  const olx_shading *shading = &tile->shadings[k];
  const olx_surface *surface = shading->surface;
  return olx_classic_glossy(tile->context->field, &tile->context->settings->sample, field_origin(surface),
                            shading->normal, view, surface->roughness, surface->bsdf.f0, surface->bsdf.f90);
}

static void light_glossily(shaded_tile *tile) {
  for (uint32_t k = 0; k < tile->count; k++) {
    const olx_shading *shading = &tile->shadings[k];
    if (!shading->has_specular) continue;
    const uint32_t i = tile->pixel[k];
    const olx_vec3 view = olx_negate(tile->rays->directions[i]);
    if (tile->context->settings->method == OLX_METHOD_CLASSIC) {
      tile->samples[i].indirect_glossy = classic_glossy(tile, k, view);
      continue;
    }
    tile->samples[i].indirect_glossy =
        olx_field_lobe_is_dim(tile->context, shading)
            ? olx_dim_light(&shading->surface->bsdf, shading->view.z,
                            olx_field_irradiance(tile->context, shading, view))
            : traced_glossy(tile, k, view);
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
