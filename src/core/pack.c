// Packs a unit vector into two bytes: of the codes around its octahedral coordinates, it takes the one whose direction
// is nearest.
#include "core/pack.h"

uint16_t olx_normal_pack(olx_vec3 n) {
  const olx_vec2 uv = olx_octahedral_encode(n);
  const int32_t base_u = (int32_t)floorf(uv.x * 254.0f), base_v = (int32_t)floorf(uv.y * 254.0f);
  uint16_t best = 0;
  float best_cosine = -2.0f;
  // Choose the code nearest on the sphere among the four around the exact coordinates.
  for (int32_t i = 0; i < 4; i++) {
    const int32_t u = base_u + (i & 1), v = base_v + (i >> 1);
    if (u < 0 || u > 254 || v < 0 || v > 254) continue;
    const uint16_t code = (uint16_t)(u | v << 8);
    const float cosine = olx_dot(olx_normal_unpack(code), n);
    if (cosine > best_cosine) {
      best_cosine = cosine;
      best = code;
    }
  }
  return best;
}
