// Evaluates many points in one call, for callers to whom each call is expensive, such as bindings of other languages.
#include <octalux/sample.h>

void olx_surface_irradiance_points(const olx_field *field, const olx_sample_settings *settings, uint32_t count,
                                   const olx_vec3 *positions, const olx_vec3 *geometric_normals,
                                   const olx_vec3 *shading_normals, const olx_vec3 *views, olx_vec3 *irradiance) {
  for (uint32_t i = 0; i < count; i++) {
    irradiance[i] =
        olx_surface_irradiance(field, settings, positions[i], geometric_normals[i], shading_normals[i], views[i]);
  }
}

void olx_irradiance_points(const olx_field *field, const olx_sample_settings *settings, uint32_t count,
                           const olx_vec3 *positions, const olx_vec3 *normals, const olx_vec3 *views,
                           olx_vec3 *irradiance) {
  for (uint32_t i = 0; i < count; i++) {
    irradiance[i] = olx_irradiance(field, settings, positions[i], normals[i], views[i]);
  }
}

void olx_volume_irradiance_points(const olx_field *field, uint32_t count, const olx_vec3 *positions,
                                  const olx_vec3 *normals, olx_vec3 *irradiance) {
  for (uint32_t i = 0; i < count; i++) irradiance[i] = olx_volume_irradiance(field, positions[i], normals[i]);
}

void olx_glossy_rays(const olx_field *field, const olx_sample_settings *settings, uint32_t count,
                     const olx_vec3 *positions, const olx_vec3 *normals, const olx_vec3 *views, const float *roughness,
                     const olx_vec2 *random, olx_vec3 *radiance, float *weights, float *half_cosines) {
  for (uint32_t i = 0; i < count; i++) {
    radiance[i] = olx_glossy(field, settings, positions[i], normals[i], views[i], roughness[i], random[i], &weights[i],
                             &half_cosines[i], NULL);
  }
}
