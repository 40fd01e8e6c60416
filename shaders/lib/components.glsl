// Reads and replaces components of vectors by numbers that are not constant. Indexing by such a number would put the
// vector into memory. It has no twin in C, where arrays are in memory anyway.
//
// SPDX-License-Identifier: MIT
#ifndef OLX_COMPONENTS_GLSL
#define OLX_COMPONENTS_GLSL

// Returns a vector with `value` in place of component i.
vec4 olx_replace(vec4 vector, int i, float value) {
  return mix(vector, vec4(value), equal(ivec4(i), ivec4(0, 1, 2, 3)));
}

// Returns component i of a vector.
float olx_component(vec4 vector, int i) {
  vec2 pair = i < 2 ? vector.xy : vector.zw;
  return (i & 1) == 0 ? pair.x : pair.y;
}

// Returns a bit for each component above 0.
uint olx_positive(vec4 vector) {
  uvec4 bits = uvec4(greaterThan(vector, vec4(0.0))) * uvec4(1u, 2u, 4u, 8u);
  return bits.x | bits.y | bits.z | bits.w;
}

#endif
