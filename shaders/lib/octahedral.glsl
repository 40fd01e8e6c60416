// Twin of src/core/octahedral.h: the octahedral map of the sphere onto the unit square.
//
// SPDX-License-Identifier: MIT
#ifndef OLX_OCTAHEDRAL_GLSL
#define OLX_OCTAHEDRAL_GLSL

#include "vec.glsl"

// Maps a direction of any finite length to [0, 1]^2; one without length to the middle.
vec2 olx_octahedral_encode(vec3 d) {
  precise float inverse = 1.0 / max(OLX_LEAST_LENGTH, abs(d.x) + abs(d.y) + abs(d.z));
  precise float x = d.x * inverse, z = d.z * inverse;
  if (d.y < 0.0) {
    precise float folded_x = (1.0 - abs(z)) * olx_sign_not_zero(x);
    z = (1.0 - abs(x)) * olx_sign_not_zero(z);
    x = folded_x;
  }
  return vec2(x * 0.5 + 0.5, z * 0.5 + 0.5);
}

// Returns the point on the octahedron |x| + |y| + |z| = 1.
vec3 olx_octahedral_point(vec2 uv) {
  precise vec3 q = vec3(uv.x * 2.0 - 1.0, 0.0, uv.y * 2.0 - 1.0);
  q.y = 1.0 - abs(q.x) - abs(q.z);
  if (q.y < 0.0) {
    precise float x = (1.0 - abs(q.z)) * olx_sign_not_zero(q.x);
    q.z = (1.0 - abs(q.x)) * olx_sign_not_zero(q.z);
    q.x = x;
  }
  return q;
}

vec3 olx_octahedral_decode(vec2 uv) { return olx_normalize(olx_octahedral_point(uv)); }

// Returns the solid angle of a texel at a point of the map, to first order: 4 / (n^2 |q|^3).
float olx_texel_solid_angle_near(vec2 uv, uint n) {
  vec3 q = olx_octahedral_point(uv);
  float length = sqrt(olx_dot(q, q));
  return 4.0 / (float(n) * float(n) * length * length * length);
}

// Returns the direction through the centre of a texel of a map with n texels a side.
vec3 olx_texel_direction(uvec2 texel, uint n) { return olx_octahedral_decode((vec2(texel) + 0.5) / float(n)); }

// Finds the texel inside the map that a texel of the one-texel border repeats; x and y are from -1 to n.
ivec2 olx_border_source(ivec2 at, int n) {
  if (at.x < 0 || at.x >= n) at = ivec2(at.x < 0 ? -1 - at.x : 2 * n - 1 - at.x, n - 1 - at.y);
  if (at.y < 0 || at.y >= n) at = ivec2(n - 1 - at.x, at.y < 0 ? -1 - at.y : 2 * n - 1 - at.y);
  return at;
}

#endif
