// The classic method, irradiance probes without visibility, which light field probes replace (docs/maths.md, "The
// baseline"). Specular light is Cook-Torrance with GGX, Schlick-GGX and Fresnel-Schlick, split into prefiltered
// radiance and a table.
#ifndef OLX_SHADE_CLASSIC_H
#define OLX_SHADE_CLASSIC_H

#include "field/maps.h"

#include <octalux/sample.h>

// Returns Schlick's approximation of Smith's masking for one direction, with k = alpha / 2, the value for image-based
// light.
static inline float olx_classic_masking(float alpha, float cosine) {
  const float k = 0.5f * alpha;
  return cosine / (cosine * (1.0f - k) + k);
}

// Returns the roughness for which a level of radiance is filtered.
static inline float olx_classic_level_roughness(uint32_t level) {
  return (float)level / (float)(OLX_CLASSIC_LEVELS - 1);
}

// Returns the direction in which the probe sees what the ray from `position` along the unit vector `direction` meets,
// if the probe's surroundings are its box. A position outside the box is moved to the nearest one in it.
olx_vec3 olx_classic_parallax(const olx_classic_box *box, olx_vec3 probe, olx_vec3 position, olx_vec3 direction);

// Returns scale and bias of F0 from a table, for the cosine between normal and eye.
olx_vec2 olx_classic_reflectance(const uint32_t *table, float cosine, float roughness);

// Returns a probe's radiance, filtered for the roughness, around a unit direction.
olx_vec3 olx_classic_radiance(const olx_classic_maps *maps, uint32_t probe, olx_vec3 direction, float roughness);

#endif
