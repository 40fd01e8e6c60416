// Twin of src/core/pack.h: the packed formats of a field, for hosts and maps whose texture units do not unpack them.
//
// SPDX-License-Identifier: MIT
#ifndef OLX_PACK_GLSL
#define OLX_PACK_GLSL

#include "octahedral.glsl"

// Unpacks any half float exactly; subnormals are built as numbers, because devices may flush subnormal floats to 0.
float olx_half_unpack(uint h) {
  uint sign = (h & 0x8000u) << 16, rest = h & 0x7FFFu;
  if (rest >= 0x7C00u) return uintBitsToFloat(sign | 0x7F800000u | (rest & 0x3FFu) << 13);
  if (rest < 0x0400u) return uintBitsToFloat(sign | floatBitsToUint(float(rest) * (1.0 / 16777216.0)));
  return uintBitsToFloat(sign | (rest << 13) + 0x38000000u);
}

// Packs a half float, rounded to nearest even; overflow becomes infinity, and NaN stays NaN. Subnormals are built as
// numbers, because devices may flush subnormal floats to 0.
uint olx_half_pack(float f) {
  uint bits = floatBitsToUint(f), sign = bits >> 16 & 0x8000u, magnitude = bits & 0x7FFFFFFFu;
  if (magnitude > 0x7F800000u) return sign | 0x7E00u;
  if (magnitude >= 0x477FF000u) return sign | 0x7C00u; // 65520 and above round to infinity
  if (magnitude < 0x38800000u) return sign | uint(roundEven(abs(f) * 16777216.0));
  return sign | (magnitude - 0x38000000u + 0x0FFFu + (magnitude >> 13 & 1u)) >> 13;
}

// Unpacks a unit vector from two bytes: octahedral coordinates in steps of 1/254, with u in the low byte.
vec3 olx_normal_unpack(uint packed) {
  precise vec2 uv = vec2(float(packed & 0xFFu), float(packed >> 8)) * (1.0 / 254.0);
  return olx_octahedral_decode(uv);
}

// Unpacks an unsigned small float with 5 exponent bits; subnormals are built as numbers, because devices may flush
// subnormal floats to 0.
float olx_small_float_unpack(uint packed, uint mantissa) {
  if (packed < 1u << mantissa) return float(packed) * (1.0 / float(16384u << mantissa));
  return uintBitsToFloat((packed << (23u - mantissa)) + 0x38000000u);
}

vec3 olx_r11g11b10f_unpack(uint packed) {
  return vec3(olx_small_float_unpack(packed & 0x7FFu, 6u), olx_small_float_unpack(packed >> 11 & 0x7FFu, 6u),
              olx_small_float_unpack(packed >> 22, 5u));
}

vec3 olx_rgb9e5_unpack(uint packed) {
  float scale = uintBitsToFloat(((packed >> 27) + 103u) << 23); // 2^(exponent - 24)
  return vec3(packed & 0x1FFu, packed >> 9 & 0x1FFu, packed >> 18 & 0x1FFu) * scale;
}


// Packs RGB9E5. Negative numbers and NaN become 0; numbers that are too large become OLX_RGB9E5_MOST.
uint olx_rgb9e5_pack(vec3 c) {
  vec3 held = vec3(c.x > 0.0 ? min(c.x, OLX_RGB9E5_MOST) : 0.0, c.y > 0.0 ? min(c.y, OLX_RGB9E5_MOST) : 0.0,
                   c.z > 0.0 ? min(c.z, OLX_RGB9E5_MOST) : 0.0);
  float most = max(held.x, max(held.y, held.z));
  uint bits = floatBitsToUint(most), exponent = bits > 111u << 23 ? (bits >> 23) - 111u : 0u;
  float scale = uintBitsToFloat((151u - exponent) << 23); // 2^(24 - exponent)
  if (roundEven(most * scale) > 511.0) {
    exponent++;
    scale *= 0.5;
  }
  uvec3 mantissa = uvec3(roundEven(held * scale));
  return mantissa.x | mantissa.y << 9 | mantissa.z << 18 | exponent << 27;
}

// Packs an unsigned small float, rounded to nearest. Negative numbers and NaN become 0; numbers that are too large
// become the largest finite value.
uint olx_small_float_pack(float f, uint mantissa) {
  if (!(f > 0.0)) return 0u;
  uint shift = 23u - mantissa, largest = (31u << mantissa) - 1u, bits = floatBitsToUint(f), packed;
  if (f < 1.0 / 16384.0) {
    packed = uint(roundEven(f * float(16384u << mantissa)));
  } else {
    if (bits >= 0x7F800000u) return largest;
    packed = (bits - 0x38000000u + (1u << (shift - 1u)) - 1u + (bits >> shift & 1u)) >> shift;
  }
  return min(packed, largest);
}

uint olx_r11g11b10f_pack(vec3 c) {
  return olx_small_float_pack(c.x, 6u) | olx_small_float_pack(c.y, 6u) << 11 | olx_small_float_pack(c.z, 5u) << 22;
}

#endif
