// Computes the light that reaches places directly from the lights of a relighter, with shadow rays of the host or
// through the field.
#include "relight/relit_direct.h"

#include "core/sampling.h"

// The rays of a batch to one light.
typedef struct light_rays {
  uint32_t count;
  olx_shadow_ray ray[OLX_RELIT_BATCH];
  olx_vec3 irradiance[OLX_RELIT_BATCH]; // at each place if nothing shadows the light
  uint32_t point[OLX_RELIT_BATCH];
  uint8_t occluded[OLX_RELIT_BATCH];
} light_rays;

static bool point_light(const olx_light *light, olx_vec3 position, olx_vec3 normal, olx_shadow_ray *ray,
                        olx_vec3 *irradiance) {
  const olx_vec3 away = olx_sub(light->position, position);
  const float length = olx_length(away), cosine = olx_dot(away, normal) / length;
  if (!(cosine > 0.0f)) return false;
  const olx_vec3 direction = olx_scale(away, 1.0f / length);
  float strength = cosine / (length * length);
  if (light->type == OLX_LIGHT_SPOT) {
    strength *= olx_spot_falloff(light->cosine_inner, light->cosine_outer, -olx_dot(direction, light->direction));
  }
  *ray = (olx_shadow_ray){position, direction, length * (1.0f - OLX_END_SHARE)};
  *irradiance = olx_scale(light->emission, strength);
  return strength > 0.0f;
}

static bool area_light(const olx_light *light, olx_vec3 position, olx_vec3 normal, olx_vec2 random, olx_shadow_ray *ray,
                       olx_vec3 *irradiance) {
  const bool half = light->type == OLX_LIGHT_TRIANGLE;
  if (half) random = olx_sample_triangle(random);
  const olx_vec3 target = olx_madd(olx_madd(light->position, light->edge_u, random.x), light->edge_v, random.y);
  const olx_vec3 area = olx_scale(olx_cross(light->edge_u, light->edge_v), half ? 0.5f : 1.0f);
  const olx_vec3 away = olx_sub(target, position);
  const float length = olx_length(away), cosine = olx_dot(away, normal) / length;
  const olx_vec3 direction = olx_scale(away, 1.0f / length);
  float facing = -olx_dot(area, direction);
  if (light->both_sides) facing = fabsf(facing);
  if (!(cosine > 0.0f && facing > 0.0f)) return false;
  *ray = (olx_shadow_ray){position, direction, length * (1.0f - OLX_END_SHARE)};
  // A light contributes at most as much as one that surrounds the place, however near it is.
  *irradiance = olx_scale(light->emission, olx_min(cosine * facing / (length * length), OLX_PI));
  return true;
}

static bool aim(const olx_light *light, olx_vec3 position, olx_vec3 normal, olx_vec2 random, olx_shadow_ray *ray,
                olx_vec3 *irradiance) {
  switch (light->type) {
  case OLX_LIGHT_SUN: {
    const float cosine = -olx_dot(light->direction, normal);
    *ray = (olx_shadow_ray){position, olx_negate(light->direction), INFINITY};
    *irradiance = olx_scale(light->emission, cosine);
    return cosine > 0.0f;
  }
  case OLX_LIGHT_POINT:
  case OLX_LIGHT_SPOT: return point_light(light, position, normal, ray, irradiance);
  case OLX_LIGHT_RECT:
  case OLX_LIGHT_TRIANGLE: return area_light(light, position, normal, random, ray, irradiance);
  default:
    *ray = (olx_shadow_ray){position, olx_normalize(olx_from_basis(olx_sample_cosine(random), normal)), INFINITY};
    *irradiance = olx_scale(light->emission, OLX_PI);
    return true;
  }
}

// Traces shadow rays through the field. An unresolved ray counts as shadowed.
static void trace_occlusion(const olx_relit_direct *direct, light_rays *rays) {
  for (uint32_t i = 0; i < rays->count; i++) {
    const olx_shadow_ray *ray = &rays->ray[i];
    const olx_trace_hit hit =
        olx_trace(direct->source, &direct->sample, ray->origin, ray->direction, ray->length_metres);
    rays->occluded[i] = hit.status != OLX_TRACE_MISS;
  }
}

static void cast(olx_relit_direct *direct, light_rays *rays) {
  const olx_relight_settings *settings = direct->lights->settings;
  if (rays->count == 0) return;
  if (settings->occlusion) settings->occlusion(settings->user, rays->ray, rays->count, rays->occluded);
  else trace_occlusion(direct, rays);
  atomic_fetch_add_explicit(&direct->shadow_rays, rays->count, memory_order_relaxed);
}

// Returns whether a ray to a lamp is short enough for its place to be near the lamp.
static bool is_close(const olx_relit_lights *lights, uint32_t light, const olx_shadow_ray *ray) {
  return lights->lamps.radius && ray->length_metres < lights->lamps.radius[light] * (1.0f - OLX_END_SHARE);
}

static void light_by(olx_relit_direct *direct, olx_relit_batch *batch, uint32_t index, uint32_t sample,
                     light_rays *rays) {
  const olx_light *light = &direct->lights->lights[index];
  const bool area = olx_light_varies(light);
  const uint32_t samples = olx_relit_samples(direct->lights, index);
  rays->count = 0;
  for (uint32_t i = 0; i < batch->count; i++) {
    const uint32_t k = rays->count;
    const olx_vec2 random =
        area ? olx_stratified2(batch->sequence[i] * samples + sample, olx_hash3(batch->seed[i], index, OLX_SALT_LIGHT))
             : (olx_vec2){0};
    if (!aim(light, batch->position[i], batch->normal[i], random, &rays->ray[k], &rays->irradiance[k])) continue;
    rays->point[rays->count++] = i;
  }
  cast(direct, rays);
  for (uint32_t k = 0; k < rays->count; k++) {
    if (rays->occluded[k]) continue;
    const uint32_t i = rays->point[k];
    if (batch->apart && is_close(direct->lights, index, &rays->ray[k])) {
      batch->close[i] = olx_add(batch->close[i], rays->irradiance[k]);
      continue;
    }
    batch->irradiance[i] = olx_madd(batch->irradiance[i], rays->irradiance[k], 1.0f / (float)samples);
    if (!area) batch->beam[i] = olx_madd(batch->beam[i], rays->ray[k].direction, olx_luminance(rays->irradiance[k]));
  }
}

// Draws a ray to a surface near a lamp.
static bool aim_near(const olx_near_lamps *lamps, olx_vec3 position, olx_vec3 normal, float random, olx_shadow_ray *ray,
                     olx_vec3 *irradiance) {
  olx_lamp_ray to;
  if (!olx_near_lamps_draw_soft(lamps, position, random, &to)) return false;
  const float cosine = olx_dot(to.direction, normal);
  *ray = (olx_shadow_ray){position, to.direction, olx_length(olx_sub(to.target, position)) * (1.0f - OLX_END_SHARE)};
  *irradiance = olx_scale(to.irradiance, cosine);
  return cosine > 0.0f;
}

static void light_from_near_lamps(olx_relit_direct *direct, olx_relit_batch *batch, uint32_t sample, light_rays *rays) {
  rays->count = 0;
  for (uint32_t i = 0; i < batch->count; i++) {
    const uint32_t k = rays->count;
    const float random =
        olx_stratified(batch->sequence[i] * OLX_LAMP_SAMPLES + sample, olx_hash2(batch->seed[i], OLX_SALT_LAMP));
    if (!aim_near(&direct->lights->lamps, batch->position[i], batch->normal[i], random, &rays->ray[k],
                  &rays->irradiance[k])) {
      continue;
    }
    rays->point[rays->count++] = i;
  }
  cast(direct, rays);
  for (uint32_t k = 0; k < rays->count; k++) {
    if (rays->occluded[k]) continue;
    olx_vec3 *near = &batch->near[rays->point[k]];
    *near = olx_madd(*near, rays->irradiance[k], 1.0f / (float)OLX_LAMP_SAMPLES);
  }
}

void olx_relit_light(olx_relit_direct *direct, olx_relit_batch *batch) {
  light_rays rays;
  for (uint32_t i = 0; i < batch->count; i++) {
    batch->irradiance[i] = batch->beam[i] = batch->close[i] = batch->near[i] = olx_splat(0.0f);
  }
  for (uint32_t index = 0; index < direct->lights->count; index++) {
    const uint32_t samples = olx_relit_samples(direct->lights, index);
    for (uint32_t sample = 0; sample < samples; sample++) light_by(direct, batch, index, sample, &rays);
  }
  if (!batch->apart || direct->lights->lamps.count == 0) return;
  for (uint32_t sample = 0; sample < OLX_LAMP_SAMPLES; sample++) light_from_near_lamps(direct, batch, sample, &rays);
}
