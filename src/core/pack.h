// The packed formats of a field: R11G11B10F, RGB9E5, half floats, and unit vectors in two bytes. Packing rounds to
// nearest. Its twin is shaders/lib/pack.glsl.
#ifndef OLX_CORE_PACK_H
#define OLX_CORE_PACK_H

#include "core/octahedral.h"

#include <string.h>

static inline uint32_t olx_float_bits(float f) {
  uint32_t bits;
  memcpy(&bits, &f, 4);
  return bits;
}
static inline float olx_bits_float(uint32_t bits) {
  float f;
  memcpy(&f, &bits, 4);
  return f;
}

// Packs an IEEE half float, rounded to nearest even; overflow becomes infinity, and NaN stays NaN.
static inline uint16_t olx_half_pack(float f) {
  const uint32_t bits = olx_float_bits(f), sign = (bits >> 16) & 0x8000u, magnitude = bits & 0x7FFFFFFFu;
  if (magnitude > 0x7F800000u) return (uint16_t)(sign | 0x7E00u);
  if (magnitude >= 0x477FF000u) return (uint16_t)(sign | 0x7C00u); // 65520 and above round to infinity
  if (magnitude < 0x38800000u) {
    // Subnormal: adding 0.5 leaves the wanted bits, rounded, at the end of the mantissa.
    const float shifted = olx_bits_float(magnitude) + 0.5f;
    return (uint16_t)(sign | (olx_float_bits(shifted) - 0x3F000000u));
  }
  const uint32_t odd = (magnitude >> 13) & 1u;
  return (uint16_t)(sign | ((magnitude - 0x38000000u + 0x0FFFu + odd) >> 13));
}

static inline float olx_half_unpack(uint16_t h) {
  const uint32_t sign = (uint32_t)(h & 0x8000u) << 16, rest = h & 0x7FFFu;
  if (rest >= 0x7C00u) return olx_bits_float(sign | 0x7F800000u | ((rest & 0x3FFu) << 13));
  // Placing the bits in a float and scaling by 2^112 handles normals and subnormals alike.
  const float magnitude = olx_bits_float(rest << 13) * 0x1p112f;
  return olx_bits_float(sign | olx_float_bits(magnitude));
}

// Packs an unsigned small float with 5 exponent bits and `mantissa` mantissa bits. Negative numbers and NaN become 0;
// numbers that are too large become the largest finite value.
static inline uint32_t olx_small_float_pack(float f, uint32_t mantissa) {
  if (!(f > 0.0f)) return 0;
  const uint32_t shift = 23 - mantissa, largest = (31u << mantissa) - 1;
  uint32_t packed;
  if (f < 0x1p-14f) {
    packed = (uint32_t)rintf(f * (float)(1u << mantissa) * 0x1p14f);
  } else {
    const uint32_t bits = olx_float_bits(f);
    if (bits >= 0x7F800000u) return largest;
    packed = (bits - 0x38000000u + (1u << (shift - 1)) - 1 + ((bits >> shift) & 1u)) >> shift;
  }
  return packed > largest ? largest : packed;
}

static inline float olx_small_float_unpack(uint32_t packed, uint32_t mantissa) {
  return olx_bits_float(packed << (23 - mantissa)) * 0x1p112f;
}

// Packs R into the low 11 bits, then G, then B into the high 10: VK_FORMAT_B10G11R11_UFLOAT_PACK32.
static inline uint32_t olx_r11g11b10f_pack(olx_vec3 c) {
  return olx_small_float_pack(c.x, 6) | olx_small_float_pack(c.y, 6) << 11 | olx_small_float_pack(c.z, 5) << 22;
}

static inline olx_vec3 olx_r11g11b10f_unpack(uint32_t packed) {
  return olx_v3(olx_small_float_unpack(packed & 0x7FFu, 6), olx_small_float_unpack((packed >> 11) & 0x7FFu, 6),
                olx_small_float_unpack(packed >> 22, 5));
}

// Packs nine bits of mantissa for each of red (low bits), green and blue, and one exponent in the high 5 bits:
// VK_FORMAT_E5B9G9R9_UFLOAT_PACK32. Negative numbers and NaN become 0; numbers that are too large become
// OLX_RGB9E5_MOST.
static inline uint32_t olx_rgb9e5_pack(olx_vec3 c) {
  const float red = c.x > 0.0f ? fminf(c.x, OLX_RGB9E5_MOST) : 0.0f,
              green = c.y > 0.0f ? fminf(c.y, OLX_RGB9E5_MOST) : 0.0f,
              blue = c.z > 0.0f ? fminf(c.z, OLX_RGB9E5_MOST) : 0.0f;
  const float most = fmaxf(red, fmaxf(green, blue));
  const uint32_t bits = olx_float_bits(most), least = 111u << 23; // 2^-16
  uint32_t exponent = bits > least ? (bits >> 23) - 111u : 0u;
  float scale = olx_bits_float((151u - exponent) << 23); // 2^(24 - exponent)
  if (rintf(most * scale) > 511.0f) {
    exponent++;
    scale *= 0.5f;
  }
  return (uint32_t)rintf(red * scale) | (uint32_t)rintf(green * scale) << 9 | (uint32_t)rintf(blue * scale) << 18 |
         exponent << 27;
}

static inline olx_vec3 olx_rgb9e5_unpack(uint32_t packed) {
  const float scale = olx_bits_float(((packed >> 27) + 103u) << 23); // 2^(exponent - 24)
  return olx_v3((float)(packed & 0x1FFu) * scale, (float)(packed >> 9 & 0x1FFu) * scale,
                (float)(packed >> 18 & 0x1FFu) * scale);
}

// Packs a unit vector into two bytes: octahedral coordinates in steps of 1/254, so that the six axes are exact, with u
// in the low byte.
uint16_t olx_normal_pack(olx_vec3 n);

static inline olx_vec3 olx_normal_unpack(uint16_t packed) {
  const olx_vec2 uv = {(float)(packed & 0xFFu) * (1.0f / 254.0f), (float)(packed >> 8) * (1.0f / 254.0f)};
  return olx_octahedral_decode(uv);
}

#endif
