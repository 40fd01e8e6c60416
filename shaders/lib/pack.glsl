// Twin of src/core/pack.h: the packed formats of a field, as far as the texture units do not unpack them.
#ifndef OLX_PACK_GLSL
#define OLX_PACK_GLSL

#include "octahedral.glsl"

// Exact for every half float; subnormals are built as numbers, because devices may flush subnormal floats to 0.
float olx_half_unpack(uint h) {
  uint sign = (h & 0x8000u) << 16, rest = h & 0x7FFFu;
  if (rest >= 0x7C00u) return uintBitsToFloat(sign | 0x7F800000u | (rest & 0x3FFu) << 13);
  if (rest < 0x0400u) return uintBitsToFloat(sign | floatBitsToUint(float(rest) * (1.0 / 16777216.0)));
  return uintBitsToFloat(sign | (rest << 13) + 0x38000000u);
}

// A unit vector in two bytes: octahedral coordinates in steps of 1/254, low byte u.
vec3 olx_normal_unpack(uint packed) {
  precise vec2 uv = vec2(float(packed & 0xFFu), float(packed >> 8)) * (1.0 / 254.0);
  return olx_octahedral_decode(uv);
}

#endif
