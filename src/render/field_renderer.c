// Renders tiles of an image with a field: surfaces and direct light by real rays, indirect light from the field, whose
// rays are traced in bundles.
#include "render/field_renderer.h"

#include "core/parallel.h"
#include "render/fixture_light.h"
#include "shade/emission.h"
#include "shade/further.h"
#include "shade/glossy.h"
#include "shade/surface_irradiance.h"

typedef struct shaded_tile {
  const olx_render_context *context;
  olx_tile_rays *rays;
  olx_camera_sample *samples;
  olx_render_stats *stats;
  uint32_t count;
  uint32_t pixel[OLX_TILE_PIXELS]; // index in the tile of each pixel that hit a surface
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
    tile->shadings[k].sky = tile->rays->sky;
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

// A ray drawn from a lobe. The radiance that it finds is scaled by `reflectance` times `weight`.
typedef struct field_ray {
  olx_vec3 origin, direction, reflectance;
  float weight;
  float density;   // with which its direction is drawn, 1/sr; 0: of a mirror
  olx_vec2 random; // random numbers that it was drawn by
} field_ray;

static bool draw_diffuse(const olx_shading *shading, olx_vec2 random, field_ray *ray) {
  const olx_vec3 local = olx_sample_cosine(random);
  *ray = (field_ray){.origin = field_origin(shading->surface),
                     .direction = olx_from_basis(local, shading->normal),
                     .reflectance = olx_splat(1.0f),
                     .weight = 1.0f,
                     .density = local.z * (1.0f / OLX_PI)};
  return olx_dot(ray->direction, shading->surface->geometric_normal) > 0.0f;
}

static bool draw_glossy(const olx_shading *shading, olx_vec3 view, olx_vec2 random, field_ray *ray) {
  const olx_surface *surface = shading->surface;
  float half_cosine;
  if (!olx_glossy_draw(shading->normal, view, surface->roughness, random, &ray->direction, &ray->weight,
                       &half_cosine)) {
    return false;
  }
  if (olx_dot(ray->direction, surface->geometric_normal) <= 0.0f) return false;
  ray->origin = field_origin(surface);
  ray->density = olx_glossy_density(shading, ray->direction);
  ray->random = random;
  ray->reflectance = olx_fresnel(&surface->bsdf, half_cosine);
  return true;
}

static olx_field_ray_light light_found(const olx_render_context *context, const field_ray *ray,
                                       const olx_trace_hit *hit) {
  const olx_vec3 light = olx_light_found(&context->settings->sample, hit, ray->origin);
  return (olx_field_ray_light){.light = olx_scale(olx_mul(ray->reflectance, light), ray->weight),
                               .nearness = olx_nearness(hit)};
}

static olx_trace_hit follow(const olx_render_context *context, olx_vec3 origin, olx_vec3 direction,
                            olx_render_stats *stats) {
  const olx_trace_hit hit = olx_trace(context->field, &context->settings->sample, origin, direction, INFINITY);
  count_ray(stats, &hit);
  return hit;
}

static olx_field_ray_light plus(olx_field_ray_light light, olx_vec3 more) {
  return (olx_field_ray_light){.light = olx_add(light.light, more), .nearness = light.nearness};
}

olx_field_ray_light olx_field_diffuse_ray(const olx_render_context *context, const olx_shading *shading,
                                          olx_vec2 random, olx_render_stats *stats) {
  field_ray ray;
  const olx_vec3 near = olx_fixtures_light(context, shading, OLX_GATHER_COSINE, random.x, &stats->rays);
  if (!draw_diffuse(shading, random, &ray)) return (olx_field_ray_light){.light = near};
  olx_trace_hit hit = follow(context, ray.origin, ray.direction, stats);
  olx_fixtures_leave(context, ray.direction, ray.density, &hit);
  return plus(light_found(context, &ray, &hit), near);
}

olx_field_ray_light olx_field_glossy_ray(const olx_render_context *context, const olx_shading *shading, olx_vec3 view,
                                         olx_vec2 random, olx_render_stats *stats) {
  field_ray ray;
  const olx_vec3 near = olx_fixtures_light(context, shading, OLX_GATHER_SPECULAR, random.x, &stats->rays);
  if (!draw_glossy(shading, view, random, &ray)) return (olx_field_ray_light){.light = near};
  olx_trace_hit hit = follow(context, ray.origin, ray.direction, stats);
  olx_fixtures_leave(context, ray.direction, ray.density, &hit);
  olx_further_ray further;
  if (olx_further_draw(context->field, &hit, ray.direction, random, &further)) {
    const olx_trace_hit found = follow(context, further.origin, further.direction, stats);
    hit.radiance = olx_further_light(&hit, &further, &found);
  }
  return plus(light_found(context, &ray, &hit), near);
}

static olx_vec3 stored_irradiance(const olx_render_context *context, const olx_ray_hit *hit, const olx_surface *surface,
                                  olx_vec3 view) {
  const olx_surface_point point = {.position = field_origin(surface),
                                   .geometric_normal = surface->geometric_normal,
                                   .vertex_normal = olx_surface_vertex_normal(context->scene, hit, surface),
                                   .shading_normal = surface->shading_normal,
                                   .view = view};
  return olx_surface_light_at(context->field, &context->settings->sample, &point).irradiance;
}

olx_vec3 olx_field_irradiance(const olx_render_context *context, const olx_ray_hit *hit, const olx_shading *shading,
                              olx_vec3 view) {
  const olx_render_settings *settings = context->settings;
  if (settings->method == OLX_METHOD_CLASSIC) {
    return olx_classic_irradiance(context->field, &settings->sample, field_origin(shading->surface), shading->normal);
  }
  const bool probes = settings->diffuse != OLX_DIFFUSE_SURFACE && context->field->info.irradiance.probe_count;
  if (!probes) return stored_irradiance(context, hit, shading->surface, view);
  return olx_irradiance(context->field, &settings->sample, field_origin(shading->surface), shading->normal, view);
}

bool olx_field_lobe_is_dim(const olx_render_context *context, const olx_shading *shading) {
  const olx_render_settings *settings = context->settings;
  if (settings->sample.emitters) return false; // irradiance is without emitters, which the lobe's rays find
  return olx_lobe_is_dim(&shading->surface->bsdf, shading->view.z, settings->dim_lobe);
}

static void light_directly(shaded_tile *tile) {
  for (uint32_t k = 0; k < tile->count; k++) {
    const uint32_t i = tile->pixel[k];
    olx_sampler *sampler = &tile->rays->samplers[i], guided;
    if (tile->rays->sky) {
      guided = olx_sky_guide_sampler(tile->rays->sky, sampler);
      sampler = &guided;
    }
    tile->samples[i].direct = olx_field_direct(tile->context, &tile->shadings[k], sampler, tile->stats);
  }
}

// Rays of a tile that are collected to be traced together, and the light that all rays have found so far.
enum { BUNDLE = 256 };

typedef struct ray_bundle {
  bool glossy; // of glossy lobes; otherwise of diffuse lobes
  uint32_t count;
  uint32_t owner[BUNDLE]; // index of the surface
  field_ray rays[BUNDLE];
  olx_vec3 sum[OLX_TILE_PIXELS];
} ray_bundle;

static void begin_bundle(ray_bundle *bundle, bool glossy) {
  bundle->glossy = glossy;
  bundle->count = 0;
  for (uint32_t k = 0; k < OLX_TILE_PIXELS; k++) bundle->sum[k] = olx_splat(0.0f);
}

static void trace_together(const shaded_tile *tile, uint32_t count, const olx_vec3 *origins, const olx_vec3 *directions,
                           olx_trace_hit *hits) {
  olx_trace_rays(tile->context->field, &tile->context->settings->sample, count, origins, directions, INFINITY, hits);
  for (uint32_t i = 0; i < count; i++) count_ray(tile->stats, &hits[i]);
}

// Traces further rays from the hits of glossy rays.
static void follow_further(const shaded_tile *tile, const ray_bundle *bundle, olx_trace_hit *hits) {
  olx_further_ray rays[BUNDLE];
  olx_vec3 origins[BUNDLE] = {{0}}, directions[BUNDLE] = {{0}};
  olx_trace_hit found[BUNDLE];
  uint32_t from[BUNDLE], count = 0;
  for (uint32_t i = 0; i < bundle->count; i++) {
    const field_ray *ray = &bundle->rays[i];
    if (!olx_further_draw(tile->context->field, &hits[i], ray->direction, ray->random, &rays[count])) continue;
    origins[count] = rays[count].origin;
    directions[count] = rays[count].direction;
    from[count++] = i;
  }
  if (count == 0) return;
  trace_together(tile, count, origins, directions, found);
  for (uint32_t k = 0; k < count; k++) {
    olx_trace_hit *first = &hits[from[k]];
    first->radiance = olx_further_light(first, &rays[k], &found[k]);
  }
}

static void follow_bundle(const shaded_tile *tile, ray_bundle *bundle) {
  olx_vec3 origins[BUNDLE] = {{0}}, directions[BUNDLE] = {{0}};
  olx_trace_hit hits[BUNDLE];
  for (uint32_t i = 0; i < bundle->count; i++) {
    origins[i] = bundle->rays[i].origin;
    directions[i] = bundle->rays[i].direction;
  }
  trace_together(tile, bundle->count, origins, directions, hits);
  for (uint32_t i = 0; i < bundle->count; i++) {
    olx_fixtures_leave(tile->context, directions[i], bundle->rays[i].density, &hits[i]);
  }
  if (bundle->glossy) follow_further(tile, bundle, hits);
  for (uint32_t i = 0; i < bundle->count; i++) {
    olx_vec3 *sum = &bundle->sum[bundle->owner[i]];
    *sum = olx_add(*sum, light_found(tile->context, &bundle->rays[i], &hits[i]).light);
  }
  bundle->count = 0;
}

// Reserves one more ray of a surface; traces the bundle first when it is full.
static field_ray *next_ray(const shaded_tile *tile, ray_bundle *bundle, uint32_t k) {
  if (bundle->count == BUNDLE) follow_bundle(tile, bundle);
  bundle->owner[bundle->count] = k;
  return &bundle->rays[bundle->count];
}

// Adds to the light of a surface one sample of surfaces near lamps.
static void add_near_lamps(const shaded_tile *tile, ray_bundle *bundle, uint32_t k, float random) {
  const olx_gathering lobe = bundle->glossy ? OLX_GATHER_SPECULAR : OLX_GATHER_COSINE;
  const olx_vec3 light = olx_fixtures_light(tile->context, &tile->shadings[k], lobe, random, &tile->stats->rays);
  bundle->sum[k] = olx_add(bundle->sum[k], light);
}

// Computes irradiance by cosine-distributed rays through the field.
static void trace_diffuse(const shaded_tile *tile, ray_bundle *bundle) {
  const uint32_t count = tile->context->settings->diffuse_samples;
  for (uint32_t k = 0; k < tile->count; k++) {
    if (!tile->shadings[k].has_diffuse) continue;
    const olx_sampler *sampler = &tile->rays->samplers[tile->pixel[k]];
    const uint32_t seed = olx_sampler_split(sampler, OLX_DIFFUSE_BRANCH).seed;
    for (uint32_t j = 0; j < count; j++) {
      const olx_vec2 random = olx_stratified2(sampler->index * count + j, seed);
      bundle->count += draw_diffuse(&tile->shadings[k], random, next_ray(tile, bundle, k));
      add_near_lamps(tile, bundle, k, random.x);
    }
  }
  follow_bundle(tile, bundle);
  for (uint32_t k = 0; k < tile->count; k++) bundle->sum[k] = olx_scale(bundle->sum[k], OLX_PI / (float)count);
}

static void light_diffusely(shaded_tile *tile) {
  const olx_render_settings *settings = tile->context->settings;
  const bool traced = settings->method == OLX_METHOD_FIELD && settings->diffuse == OLX_DIFFUSE_TRACED;
  ray_bundle bundle;
  begin_bundle(&bundle, false);
  if (traced) trace_diffuse(tile, &bundle);
  for (uint32_t k = 0; k < tile->count; k++) {
    const olx_shading *shading = &tile->shadings[k];
    if (!shading->has_diffuse) continue;
    const uint32_t i = tile->pixel[k];
    const olx_vec3 view = olx_negate(tile->rays->directions[i]);
    const olx_vec3 irradiance =
        traced ? bundle.sum[k] : olx_field_irradiance(tile->context, &tile->rays->hits[i], shading, view);
    tile->samples[i].indirect_diffuse = olx_scale(olx_mul(shading->diffuse, irradiance), 1.0f / OLX_PI);
  }
}

static void light_by_classic_maps(shaded_tile *tile) {
  for (uint32_t k = 0; k < tile->count; k++) {
    const olx_shading *shading = &tile->shadings[k];
    if (!shading->has_specular) continue;
    const uint32_t i = tile->pixel[k];
    const olx_surface *surface = shading->surface;
    tile->samples[i].indirect_glossy = olx_classic_glossy(
        tile->context->field, &tile->context->settings->sample, field_origin(surface), shading->normal,
        olx_negate(tile->rays->directions[i]), surface->roughness, surface->bsdf.f0, surface->bsdf.f90);
  }
}

static uint32_t glossy_count(const shaded_tile *tile, const olx_shading *shading) {
  return shading->surface->bsdf.alpha > 0.0f ? tile->context->settings->glossy_samples : 1;
}

static void light_glossily(shaded_tile *tile) {
  ray_bundle bundle;
  begin_bundle(&bundle, true);
  bool dim[OLX_TILE_PIXELS];
  for (uint32_t k = 0; k < tile->count; k++) {
    const olx_shading *shading = &tile->shadings[k];
    dim[k] = olx_field_lobe_is_dim(tile->context, shading);
    if (!shading->has_specular || dim[k]) continue;
    const olx_sampler *sampler = &tile->rays->samplers[tile->pixel[k]];
    const uint32_t seed = olx_sampler_split(sampler, OLX_GLOSSY_BRANCH).seed, count = glossy_count(tile, shading);
    const olx_vec3 view = olx_negate(tile->rays->directions[tile->pixel[k]]);
    for (uint32_t j = 0; j < count; j++) {
      const olx_vec2 random = olx_stratified2(sampler->index * count + j, seed);
      bundle.count += draw_glossy(shading, view, random, next_ray(tile, &bundle, k));
      add_near_lamps(tile, &bundle, k, random.x);
    }
  }
  follow_bundle(tile, &bundle);
  for (uint32_t k = 0; k < tile->count; k++) {
    const olx_shading *shading = &tile->shadings[k];
    if (!shading->has_specular) continue;
    const uint32_t i = tile->pixel[k];
    const olx_vec3 view = olx_negate(tile->rays->directions[i]);
    tile->samples[i].indirect_glossy =
        dim[k] ? olx_dim_light(&shading->surface->bsdf, shading->view.z,
                               olx_field_irradiance(tile->context, &tile->rays->hits[i], shading, view))
               : olx_scale(bundle.sum[k], 1.0f / (float)glossy_count(tile, shading));
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
  if (context->settings->method == OLX_METHOD_CLASSIC) light_by_classic_maps(&tile);
  else light_glossily(&tile);
  stats->primary_seconds += found - start;
  stats->direct_seconds += direct - found;
  stats->diffuse_seconds += diffuse - direct;
  stats->glossy_seconds += olx_thread_seconds() - diffuse;
}
