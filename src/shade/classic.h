// The baseline: irradiance probes without visibility, the method that light field probes replace (docs/maths.md, "The
// baseline"). Specular light is Cook-Torrance with GGX, Schlick-GGX and Fresnel-Schlick, split into prefiltered
// radiance and a table.
#ifndef OLX_SHADE_CLASSIC_H
#define OLX_SHADE_CLASSIC_H

#include "field/maps.h"

#include <octalux/sample.h>

// Schlick's approximation of Smith's masking for one direction, with the k of light from images: alpha / 2.
static inline float olx_classic_masking(float alpha, float cosine) {
  const float k = 0.5f * alpha;
  return cosine / (cosine * (1.0f - k) + k);
}

// The roughness for which a level of radiance is filtered.
static inline float olx_classic_level_roughness(uint32_t level) {
  return (float)level / (float)(OLX_CLASSIC_LEVELS - 1);
}

// The direction in which the probe sees what the ray from `position` along the unit vector `direction` meets, when the
// probe's surroundings are its box. A position outside the box counts as the nearest one in it.
olx_vec3 olx_classic_parallax(const olx_classic_box *box, olx_vec3 probe, olx_vec3 position, olx_vec3 direction);

// Scale and bias of F0 from a table, for the cosine between normal and eye.
olx_vec2 olx_classic_reflectance(const uint32_t *table, float cosine, float roughness);

// Radiance of a probe, filtered for the roughness, around a unit direction.
olx_vec3 olx_classic_radiance(const olx_classic_maps *maps, uint32_t probe, olx_vec3 direction, float roughness);

#endif
