// Twin of src/core/sampling.h: deterministic random numbers.
//
// SPDX-License-Identifier: MIT
#ifndef OLX_SAMPLING_GLSL
#define OLX_SAMPLING_GLSL

#include "vec.glsl"

// Returns a well-mixed 32-bit hash.
uint olx_hash(uint x) {
  x = x * 747796405u + 2891336453u;
  x = ((x >> ((x >> 28) + 4u)) ^ x) * 277803737u;
  return (x >> 22) ^ x;
}

uint olx_hash2(uint a, uint b) { return olx_hash(a ^ (olx_hash(b) + 0x9E3779B9u)); }

uint olx_hash3(uint a, uint b, uint c) { return olx_hash2(olx_hash2(a, b), c); }

// Converts the upper 24 bits to a number in [0, 1).
float olx_unit_float(uint bits) { return float(bits >> 8) * (1.0 / 16777216.0); }

// Applies Owen scrambling by hashing to a number with reversed bits.
uint olx_owen_scramble(uint x, uint seed) {
  x = bitfieldReverse(x);
  x += seed;
  x ^= x * 0x6C50B47Cu;
  x ^= x * 0xB82F1E52u;
  x ^= x * 0xC7AFE638u;
  x ^= x * 0x8D22F6E6u;
  return bitfieldReverse(x);
}

// Returns the second dimension of Sobol's sequence.
uint olx_sobol2(uint index) {
  uint x = index;
  x ^= (x >> 16) & 0x0000FFFFu;
  x ^= (x >> 8) & 0x00FF00FFu;
  x ^= (x >> 4) & 0x0F0F0F0Fu;
  x ^= (x >> 2) & 0x33333333u;
  x ^= (x >> 1) & 0x55555555u;
  return bitfieldReverse(x);
}

// Returns point i of an Owen-scrambled, shuffled (0, 2)-sequence.
vec2 olx_stratified2(uint i, uint seed) {
  uint index = olx_owen_scramble(i, olx_hash(seed));
  return vec2(olx_unit_float(olx_owen_scramble(bitfieldReverse(index), olx_hash(seed + 1u))),
              olx_unit_float(olx_owen_scramble(olx_sobol2(index), olx_hash(seed + 2u))));
}

// Returns a cosine-distributed direction around +z; pdf = cos / pi.
vec3 olx_sample_cosine(vec2 random) {
  return vec3(sqrt(random.x) * olx_turn(random.y), sqrt(max(0.0, 1.0 - random.x)));
}

// Returns barycentric coordinates (of the second and third corner), uniform over a triangle.
vec2 olx_sample_triangle(vec2 random) {
  float s = sqrt(random.x);
  return vec2(s * (1.0 - random.y), s * random.y);
}

#endif
