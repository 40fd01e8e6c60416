// Light that leaves the surface of a texel towards an eye of the caller's, not that of the probe.
#ifndef OLX_TRACE_TEXEL_SHADE_H
#define OLX_TRACE_TEXEL_SHADE_H

#include "field/texels.h"

#include <octalux/sample.h>

// Radiance in W/(sr m^2) that a ray along `direction` (unit) finds at a texel's surface: what the diffuse lobe reflects of
// direct and indirect light and, where settings->emitters says so, emission. Of the sky it is emission alone.
static inline olx_vec3 olx_texel_shade(const olx_field *field, const olx_sample_settings *settings, uint32_t probe,
                                       size_t texel, olx_vec3 direction) {
  const olx_bsdf bsdf = olx_texel_material(field, probe, texel);
  const float cosine = fabsf(olx_dot(olx_texel_normal(field, probe, texel), direction));
  const olx_vec3 irradiance = olx_add(olx_texel_direct(field, probe, texel), olx_texel_indirect(field, probe, texel));
  const olx_vec3 reflected = olx_scale(olx_mul(olx_bsdf_diffuse(&bsdf, cosine), irradiance), 1.0f / OLX_PI);
  return settings->emitters ? olx_add(olx_texel_emission(field, probe, texel), reflected) : reflected;
}

#endif
