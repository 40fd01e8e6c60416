// Metalness and specular weight in one byte, so that base colour, roughness and this byte fill a texel: surfaces are
// either metallic or have a weight other than 1, never both.
#ifndef OLX_BLOCK_REFLECTANCE_H
#define OLX_BLOCK_REFLECTANCE_H

#include "core/vec.h"

typedef struct olx_reflectance {
  float metallic, specular_weight;
} olx_reflectance;

// Packs both values, each from 0 to 1. A metallic surface gets a weight of 1.
static inline uint8_t olx_reflectance_pack(olx_reflectance r) {
  const float full = OLX_REFLECTANCE_FULL;
  return (uint8_t)(r.metallic * (255.0f - full) >= 0.5f ? full + rintf(r.metallic * (255.0f - full))
                                                        : rintf(r.specular_weight * full));
}

static inline olx_reflectance olx_reflectance_unpack(uint32_t code) {
  const float metallic = ((float)code - OLX_REFLECTANCE_FULL) * (1.0f / (255.0f - OLX_REFLECTANCE_FULL)),
              weight = (float)code * (1.0f / OLX_REFLECTANCE_FULL);
  return (olx_reflectance){olx_max(metallic, 0.0f), olx_min(weight, 1.0f)};
}

#endif
