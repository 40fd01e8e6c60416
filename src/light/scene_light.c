// Solves the light of a scene by its steps (light_steps.c), and evaluates the irradiance of a surface: interpolated
// between surfels, or gathered by rays where interpolation is unreliable.
#include "light/scene_light.h"

#include "core/hooks.h"
#include "core/result.h"
#include "core/sampling.h"
#include "light/solution/light_noise.h"
#include "light/solution/light_steps.h"
#include "light/solution/light_units.h"

enum {
  LEAST_MAP_SIZE = 64,  // smaller maps still get surfels this dense: light sampled more coarsely is biased
  LEAST_NEIGHBOURS = 3, // with fewer surfels around it, a point casts rays of its own
  MOST_BATCHES = 4,
  SALT_GATHER = 0x47415448
};

// Light is not interpolated where the standard deviation over the neighbours is above this share of the mean.
static const float ROUGH_SPREAD = 0.3f;
// Where few surfels determine it, it is not interpolated above this share either, unless the rays that the point would
// cast itself are expected to be less certain: their standard error, times this factor, is a share that is allowed,
// too.
static const float FEW_SPREAD = 0.1f, FEW_NOISE = 1.5f;
// A point's own rays are as many as bring the standard error that is expected of them to this multiple of the bound on
// noise, but for at most MOST_BATCHES times OLX_GATHER_RAYS.
static const float GATHER_NOISE = 4.0f;
// Bound on the light of one gathered ray, as a share of the light around the point.
static const float MOST_OF_A_RAY = 0.25f;

uint64_t olx_scene_light_most_link_bytes(void) {
  return olx_scene_light_settings_default().most_links * sizeof(olx_link);
}

olx_scene_light_settings olx_scene_light_settings_default(void) {
  return (olx_scene_light_settings){.bounces = OLX_BOUNCES_INFINITE,
                                    .noise = 0.02f,
                                    .spacing = 0.2f,
                                    .map_size = 512,
                                    .most_links = 1u << 27,
                                    .most_final_rays = 1u << 28};
}

static olx_result build(olx_scene_light *l) {
  const double start = olx_seconds();
  OLX_TRY(olx_light_units_run(l));
  OLX_TRY(olx_light_units_look_up(l));
  l->report.surfels = l->surfels.count;
  l->report.rays += l->surfels.rays;
  l->report.bytes = l->report.links * sizeof(olx_link) +
                    l->surfels.count * (sizeof(olx_light_surfel) + 3 * sizeof(olx_vec3)) +
                    l->surfels.point_count * sizeof(olx_surface_point);
  l->report.seconds = olx_seconds() - start;
  return OLX_OK;
}

olx_result olx_scene_light_make(const olx_scene *scene, const olx_scene_light_settings *settings,
                                const olx_vec3 *positions, const uint8_t *flags, uint32_t count,
                                olx_scene_light **light) {
  olx_scene_light *l = *light = olx_allocate_zero(1, sizeof *l);
  if (!l) return olx_fail(OLX_ERROR_MEMORY, "light: out of memory");
  l->scene = scene;
  l->settings = *settings;
  if (l->settings.map_size < LEAST_MAP_SIZE) l->settings.map_size = LEAST_MAP_SIZE;
  l->links.batches = l->batches;
  l->positions = positions;
  l->flags = flags;
  l->probe_count = count;
  return OLX_OK;
}

olx_result olx_scene_light_create(const olx_scene *scene, const olx_scene_light_settings *settings,
                                  const olx_vec3 *positions, const uint8_t *flags, uint32_t count,
                                  olx_scene_light **light) {
  olx_scene_light *l;
  *light = NULL;
  OLX_TRY(olx_scene_light_make(scene, settings, positions, flags, count, &l));
  const olx_result result = build(l);
  l->positions = NULL;
  l->flags = NULL;
  if (result == OLX_OK) {
    *light = l;
  } else {
    olx_scene_light_free(l);
  }
  return result;
}

void olx_scene_light_free(olx_scene_light *l) {
  if (!l) return;
  olx_scene_light_clear(l);
  olx_release(l);
}

olx_result olx_scene_light_load_links(olx_scene_light *l) { return olx_light_units_load_links(l); }

uint32_t olx_scene_light_bounces(const olx_scene_light *l) { return l->settings.bounces; }

olx_scene_light_report olx_scene_light_describe(const olx_scene_light *light) {
  olx_scene_light_report report = light->report;
  report.reused_rays = atomic_load(&light->reused_rays);
  return report;
}

olx_scene_light_parts olx_scene_light_open(const olx_scene_light *l) {
  return (olx_scene_light_parts){&l->surfels, &l->links, &l->lookup, l->direct, l->irradiance};
}

// Returns the irradiance of a point by `batches` times OLX_GATHER_RAYS rays of its own.
static olx_vec3 gather(const olx_scene_light *l, const olx_surface *surface, uint32_t batches, olx_gather_row *row) {
  const uint64_t key = olx_cell_key(&l->surfels.grid, surface->position, surface->geometric_normal);
  const uint32_t seed = olx_hash3(l->surfels.seed ^ (uint32_t)key, (uint32_t)(key >> 32), SALT_GATHER);
  const uint32_t near = olx_light_surfels_find(&l->surfels, key, surface, INFINITY).surfel;
  const olx_ray_pool *pool = near == OLX_CELL_NONE ? NULL : olx_light_pool(l, near);
  const float around = near == OLX_CELL_NONE ? INFINITY : olx_luminance(l->irradiance[near]);
  const olx_passed_light light = {l->direct, l->passed_on, l->settings.bounces,
                                  MOST_OF_A_RAY * (float)(batches * OLX_GATHER_RAYS) * around};
  olx_vec3 sum = {0};
  for (uint32_t i = 0; i < batches; i++) {
    sum = olx_add(sum, olx_links_gather(&l->surfels, surface, pool, i ? olx_hash2(seed, i) : seed, &light, row));
  }
  return olx_scale(sum, 1.0f / (float)batches);
}

// Returns the standard error that is expected of OLX_GATHER_RAYS rays of a point's own, as a share of the light around
// it.
static float expected_error(const olx_scene_light *l, const olx_surfel_weights *weights) {
  float sum = 0.0f, deviation = 0.0f;
  for (uint32_t i = 0; i < weights->count; i++) {
    const float weight = fabsf(weights->weight[i]);
    sum += weight;
    deviation += weight * olx_scene_light_deviation(l, weights->surfel[i]);
  }
  return deviation / (sum * sqrtf(OLX_GATHER_RAYS));
}

// Returns the number of batches of rays that bring the expected error of a gather to its bound.
static uint32_t batches_wanted(const olx_scene_light *l, float error) {
  const float bound = GATHER_NOISE * l->settings.noise;
  uint32_t batches = 1;
  while (batches < MOST_BATCHES && error > bound * sqrtf((float)batches)) batches *= 2;
  return batches;
}

// Returns the standard deviation up to which the light of some neighbours is interpolated, as a share of its mean.
static float most_spread(const olx_scene_light *l, const olx_surfel_weights *weights) {
  if (weights->count >= OLX_NEIGHBOURS_FEW) return ROUGH_SPREAD;
  const float error = expected_error(l, weights), rays = (float)batches_wanted(l, error);
  return olx_clamp(FEW_NOISE * error / sqrtf(rays), FEW_SPREAD, ROUGH_SPREAD);
}

// Returns whether light varies too much between the neighbours to be interpolated.
static bool is_rough(const olx_scene_light *l, const olx_surfel_weights *weights) {
  float sum = 0.0f, mean = 0.0f, square = 0.0f;
  for (uint32_t i = 0; i < weights->count; i++) {
    const float weight = fabsf(weights->weight[i]), light = olx_luminance(l->irradiance[weights->surfel[i]]);
    sum += weight;
    mean += weight * light;
    square += weight * light * light;
  }
  mean /= sum;
  return square / sum - mean * mean > olx_square(most_spread(l, weights) * mean);
}

// Interpolates `light`, one value per neighbour in their order.
static olx_vec3 interpolate(const olx_surfel_weights *weights, const olx_vec3 light[OLX_NEIGHBOURS_MOST]) {
  olx_vec3 sum = {0}, least = olx_splat(INFINITY), most = olx_splat(0.0f);
  for (uint32_t i = 0; i < weights->count; i++) {
    sum = olx_madd(sum, light[i], weights->weight[i]);
    least = olx_min_each(least, light[i]);
    most = olx_max_each(most, light[i]);
  }
  // Slopes extrapolate slightly beyond the values that they were fitted to, and no farther.
  const olx_vec3 margin = olx_scale(olx_sub(most, least), 0.25f);
  return olx_max_each(olx_min_each(sum, olx_add(most, margin)), olx_max_each(olx_sub(least, margin), olx_splat(0.0f)));
}

// Returns the irradiance of a surfel with one bounce less.
static olx_vec3 before(const olx_scene_light *l, uint32_t surfel) {
  return olx_max_each(olx_sub(l->passed_on[surfel], l->direct[surfel]), olx_splat(0.0f));
}

bool olx_scene_light_interpolate(const olx_scene_light *l, const olx_surface *surface, olx_vec3 *irradiance) {
  const olx_surfel_weights weights = olx_surfel_weigh(&l->lookup, surface);
  if (weights.count < LEAST_NEIGHBOURS || is_rough(l, &weights)) return false;
  olx_vec3 light[OLX_NEIGHBOURS_MOST];
  for (uint32_t i = 0; i < weights.count; i++) light[i] = l->irradiance[weights.surfel[i]];
  *irradiance = interpolate(&weights, light);
  return true;
}

olx_vec3 olx_scene_light_gather(const olx_scene_light *l, const olx_surface *surface, olx_gather_row *row) {
  const olx_surfel_weights weights = olx_surfel_weigh(&l->lookup, surface);
  return gather(l, surface, weights.count > 0 ? batches_wanted(l, expected_error(l, &weights)) : 1, row);
}

olx_vec3 olx_scene_light_irradiance(const olx_scene_light *l, const olx_surface *surface) {
  olx_vec3 irradiance;
  return olx_scene_light_interpolate(l, surface, &irradiance) ? irradiance : olx_scene_light_gather(l, surface, NULL);
}

olx_vec3 olx_scene_light_irradiance_before(const olx_scene_light *l, const olx_surface *surface) {
  const olx_surfel_weights weights = olx_surfel_weigh(&l->lookup, surface);
  olx_vec3 light[OLX_NEIGHBOURS_MOST];
  for (uint32_t i = 0; i < weights.count; i++) light[i] = before(l, weights.surfel[i]);
  if (weights.count > 0) return interpolate(&weights, light);
  const uint64_t key = olx_cell_key(&l->surfels.grid, surface->position, surface->geometric_normal);
  const uint32_t found = olx_light_surfels_find(&l->surfels, key, surface, INFINITY).surfel;
  return found == OLX_CELL_NONE ? olx_splat(0.0f) : before(l, found);
}
