// Deterministic random numbers, and samples of distributions drawn from them. Its twin is shaders/lib/sampling.glsl.
#ifndef OLX_CORE_SAMPLING_H
#define OLX_CORE_SAMPLING_H

#include "core/vec.h"

// Returns a well-mixed 32-bit hash (the output permutation of PCG over a multiply chain).
static inline uint32_t olx_hash(uint32_t x) {
  x = x * 747796405u + 2891336453u;
  x = ((x >> ((x >> 28) + 4u)) ^ x) * 277803737u;
  return (x >> 22) ^ x;
}
static inline uint32_t olx_hash2(uint32_t a, uint32_t b) { return olx_hash(a ^ (olx_hash(b) + 0x9E3779B9u)); }
static inline uint32_t olx_hash3(uint32_t a, uint32_t b, uint32_t c) { return olx_hash2(olx_hash2(a, b), c); }

// Converts the upper 24 bits to a number in [0, 1).
static inline float olx_unit_float(uint32_t bits) { return (float)(bits >> 8) * 0x1p-24f; }

static inline uint32_t olx_reverse_bits(uint32_t x) {
  x = (x >> 16) | (x << 16);
  x = ((x & 0x00FF00FFu) << 8) | ((x & 0xFF00FF00u) >> 8);
  x = ((x & 0x0F0F0F0Fu) << 4) | ((x & 0xF0F0F0F0u) >> 4);
  x = ((x & 0x33333333u) << 2) | ((x & 0xCCCCCCCCu) >> 2);
  return ((x & 0x55555555u) << 1) | ((x & 0xAAAAAAAAu) >> 1);
}

static inline olx_vec2 olx_hammersley(uint32_t i, uint32_t count) {
  return (olx_vec2){((float)i + 0.5f) / (float)count, olx_unit_float(olx_reverse_bits(i))};
}

// Applies Owen scrambling by hashing (Laine and Karras 2011) to a number with reversed bits; the result's bits are
// reversed too.
static inline uint32_t olx_owen_scramble_reversed(uint32_t x, uint32_t seed) {
  x += seed;
  x ^= x * 0x6C50B47Cu;
  x ^= x * 0xB82F1E52u;
  x ^= x * 0xC7AFE638u;
  x ^= x * 0x8D22F6E6u;
  return x;
}

// Returns the second dimension of Sobol's sequence with reversed bits. Its matrix is Pascal's triangle modulo 2, so bit
// j of the number is the parity of those index bits whose position contains j: five steps, one for each bit of a
// position.
static inline uint32_t olx_sobol2_reversed(uint32_t index) {
  uint32_t x = index;
  x ^= (x >> 16) & 0x0000FFFFu;
  x ^= (x >> 8) & 0x00FF00FFu;
  x ^= (x >> 4) & 0x0F0F0F0Fu;
  x ^= (x >> 2) & 0x33333333u;
  x ^= (x >> 1) & 0x55555555u;
  return x;
}

// Returns point i of an Owen-scrambled, shuffled (0, 2)-sequence: stratified over every power of two of points, and
// independent of other seeds. Each pair of dimensions of a pixel or texel needs its own seed. The first dimension is
// the index with reversed bits.
static inline olx_vec2 olx_stratified2(uint32_t i, uint32_t seed) {
  const uint32_t index = olx_reverse_bits(olx_owen_scramble_reversed(olx_reverse_bits(i), olx_hash(seed)));
  const uint32_t x = olx_owen_scramble_reversed(index, olx_hash(seed + 1u)),
                 y = olx_owen_scramble_reversed(olx_sobol2_reversed(index), olx_hash(seed + 2u));
  return (olx_vec2){olx_unit_float(olx_reverse_bits(x)), olx_unit_float(olx_reverse_bits(y))};
}

// Returns the first coordinate of olx_stratified2.
static inline float olx_stratified(uint32_t i, uint32_t seed) {
  const uint32_t index = olx_reverse_bits(olx_owen_scramble_reversed(olx_reverse_bits(i), olx_hash(seed)));
  return olx_unit_float(olx_reverse_bits(olx_owen_scramble_reversed(index, olx_hash(seed + 1u))));
}

// Returns a cosine-distributed direction around +z; pdf = cos / pi.
static inline olx_vec3 olx_sample_cosine(olx_vec2 random) {
  const float r = sqrtf(random.x), phi = 2.0f * OLX_PI * random.y;
  return olx_v3(r * cosf(phi), r * sinf(phi), sqrtf(olx_max(0.0f, 1.0f - random.x)));
}

// Returns a uniform direction on the sphere; pdf = 1 / (4 pi).
static inline olx_vec3 olx_sample_sphere(olx_vec2 random) {
  const float z = 1.0f - 2.0f * random.x, r = sqrtf(olx_max(0.0f, 1.0f - z * z)), phi = 2.0f * OLX_PI * random.y;
  return olx_v3(r * cosf(phi), r * sinf(phi), z);
}

// Returns a number in [0, 1] with a density proportional to a line from r0 at 0 to r1 at 1, both at least 0; uniform
// when both are 0.
static inline float olx_sample_linear(float r0, float r1, float random) {
  const float below = r0 + sqrtf((1.0f - random) * r0 * r0 + random * r1 * r1);
  return below > 0.0f ? olx_min(random * (r0 + r1) / below, 1.0f) : random;
}

// Returns barycentric coordinates (of the second and third corner), uniform over a triangle.
static inline olx_vec2 olx_sample_triangle(olx_vec2 random) {
  const float s = sqrtf(random.x);
  return (olx_vec2){s * (1.0f - random.y), s * random.y};
}

#endif
