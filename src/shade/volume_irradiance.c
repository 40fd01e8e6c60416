// Looks up irradiance in the volume: interpolates the spherical harmonics of the eight probes of the cell around a
// place, on the place's side of the surfaces that divide it. Its twin is shaders/lib/volume_irradiance.glsl.
#include "shade/volume_irradiance.h"

#include <assert.h>

bool olx_volume_gather(const olx_field *field, olx_vec3 position, olx_vec3 normal, olx_volume_light_at *light) {
  const olx_volume *volume = &field->volume;
  olx_volume_place place;
  if (!olx_volume_answers(field) || !olx_volume_find_at(volume, position, normal, &place)) return false;
  *light = (olx_volume_light_at){.coefficients = {{0}}};
  for (uint32_t i = 0; i < OLX_VOLUME_CORNERS; i++) {
    const uint16_t *halves = volume->irradiance + (size_t)OLX_VOLUME_HALVES * place.probes[i];
    for (uint32_t k = 0; k < OLX_HARMONICS_MOST; k++) {
      light->coefficients[k] = olx_madd(light->coefficients[k], olx_harmonics_coefficient(halves, k), place.weights[i]);
    }
  }
  return true;
}

olx_vec3 olx_volume_towards(const olx_volume_light_at *light, olx_vec3 normal) {
  float values[OLX_HARMONICS_MOST];
  olx_harmonics_at(normal, values);
  olx_vec3 sum = {0};
  for (uint32_t k = 0; k < OLX_HARMONICS_MOST; k++) sum = olx_madd(sum, light->coefficients[k], values[k]);
  return olx_max_each(sum, olx_splat(0.0f));
}

olx_vec3 olx_volume_bent(const olx_volume_light_at *light, olx_vec3 smooth, olx_vec3 bent) {
  // This share of a cosine lobe about `bent` lies below the surface. Light from there is taken to be uniform, equal to
  // what arrives at a surface facing this one.
  const float below = 0.5f - 0.5f * olx_dot(smooth, bent);
  float values[OLX_HARMONICS_MOST], behind[OLX_HARMONICS_MOST];
  olx_harmonics_at(bent, values);
  olx_harmonics_at(olx_negate(smooth), behind);
  olx_vec3 sum = {0};
  for (uint32_t k = 0; k < OLX_HARMONICS_MOST; k++) {
    sum = olx_madd(sum, light->coefficients[k], values[k] - below * behind[k]);
  }
  return olx_max_each(sum, olx_splat(0.0f));
}

olx_vec3 olx_volume_irradiance(const olx_field *field, olx_vec3 position, olx_vec3 normal) {
  assert(field);
  olx_volume_light_at light;
  if (!olx_finite(position) || !olx_finite(normal)) return olx_splat(0.0f);
  if (olx_volume_gather(field, position, normal, &light)) return olx_volume_towards(&light, normal);
  if (olx_volume_answers(field)) return olx_splat(0.0f);
  const olx_sample_settings settings = olx_sample_settings_default();
  return olx_irradiance(field, &settings, position, normal, normal);
}
