// Twin of src/core/vec.h: functions that GLSL lacks or leaves undefined in part.
//
// SPDX-License-Identifier: MIT
#ifndef OLX_VEC_GLSL
#define OLX_VEC_GLSL

#include "language.glsl"

#include "../octalux_shared.h"

#define OLX_INFINITY uintBitsToFloat(0x7F800000u)

float olx_square(float x) { return x * x; }

// Returns -1 for negative numbers, else 1 (also for 0), as the octahedral map requires.
float olx_sign_not_zero(float x) { return x >= 0.0 ? 1.0 : -1.0; }

// Tests bits, because compilers may assume that floats are finite.
bool olx_finite(vec3 a) {
  return all(notEqual(floatBitsToUint(a) & uvec3(0x7F800000u), uvec3(0x7F800000u)));
}

// Computes dot() with a fixed order of additions, because the tracers' decisions depend on the last bit.
float olx_dot(vec3 a, vec3 b) {
  precise float sum = a.x * b.x + a.y * b.y + a.z * b.z;
  return sum;
}

// Returns the unit vector; a vector of length 0 is returned unchanged.
vec3 olx_normalize(vec3 a) {
  float length = sqrt(olx_dot(a, a));
  return length > 0.0 ? a * (1.0 / length) : a;
}

// Returns the cosine and sine of `turns` full turns, from 0 to 1. The languages allow errors of 2^-11 in their own
// functions. In browsers that draw in software the errors are about that large, and the rim of a lobe magnifies them a
// thousandfold, so there the values are computed here, to 10^-7.
vec2 olx_turn(float turns) {
#ifdef GL_ES
  float quarters = floor(4.0 * turns + 0.5), a = (4.0 * turns - quarters) * (0.5 * OLX_PI), z = a * a;
  float sine = a * (1.0 + z * (-1.0 / 6.0 + z * (1.0 / 120.0 + z * (-1.0 / 5040.0 + z * (1.0 / 362880.0)))));
  float cosine = 1.0 + z * (-0.5 + z * (1.0 / 24.0 + z * (-1.0 / 720.0 + z * (1.0 / 40320.0))));
  vec2 turned = (int(quarters) & 1) != 0 ? vec2(-sine, cosine) : vec2(cosine, sine);
  return (int(quarters) & 2) != 0 ? -turned : turned;
#else
  float angle = 2.0 * OLX_PI * turns;
  return vec2(cos(angle), sin(angle));
#endif
}

// Returns the Rec.709 luminance.
float olx_luminance(vec3 c) { return 0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z; }

// Computes two unit vectors that complete the unit vector n to a right-handed orthonormal basis (Duff et al. 2017).
void olx_basis(vec3 n, out vec3 tangent, out vec3 bitangent) {
  float s = n.z >= 0.0 ? 1.0 : -1.0, a = -1.0 / (s + n.z), b = n.x * n.y * a;
  tangent = vec3(1.0 + s * n.x * n.x * a, s * b, -s * n.x);
  bitangent = vec3(b, s + n.y * n.y * a, -n.y);
}

// Converts coordinates in the basis of n to world space.
vec3 olx_from_basis(vec3 local, vec3 n) {
  vec3 t, b;
  olx_basis(n, t, b);
  return t * local.x + b * local.y + n * local.z;
}

#endif
