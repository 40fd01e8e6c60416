// The irradiance volume, one row a dispatch, one thread an item.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "parity_rows.h"

layout(local_size_x = 64) in;
layout(push_constant) uniform row_block { uint row; };

struct volume_item {
  vec4 position, normal;
};
layout(set = 0, binding = 0, std430) readonly buffer items_block { volume_item items[]; };
layout(set = 0, binding = 1, std430) writeonly buffer results_block { uint results[]; };
layout(set = 0, binding = 2, std430) readonly buffer words_block { uint words[]; };

uint olx_volume_word(uint index) { return words[index]; }

#include "shaders/lib/volume_irradiance.glsl"

uint filled = 0u;
void put(uint x) { results[gl_GlobalInvocationID.x * PARITY_RESULTS + filled++] = x; }
void put(float x) { put(floatBitsToUint(x)); }
void put(vec3 v) { put(v.x), put(v.y), put(v.z); }

void main() {
  vec3 position = items[gl_GlobalInvocationID.x].position.xyz, normal = items[gl_GlobalInvocationID.x].normal.xyz;
  uint cell;
  float weights[8], values[9];
  vec3 coefficients[9];
  switch (row) {
  case ROW_olx_volume_find:
    put(olx_volume_find(position, cell, weights) ? 1u : 0u), put(cell);
    for (uint i = 0u; i < 8u; i++) put(weights[i]);
    break;
  case ROW_olx_volume_coefficient:
    for (uint k = 0u; k < 6u; k++) put(olx_volume_coefficient(gl_GlobalInvocationID.x % words[10], k + 3u));
    break;
  case ROW_olx_harmonics_at:
    olx_harmonics_at(normal, values);
    for (uint k = 0u; k < 9u; k++) put(values[k]);
    break;
  case ROW_olx_volume_gather:
    put(olx_volume_gather(position, normal, coefficients) ? 1u : 0u);
    for (uint k = 0u; k < 5u; k++) put(coefficients[k]);
    break;
  case ROW_olx_volume_towards:
    olx_volume_gather(position, normal, coefficients);
    put(olx_volume_towards(coefficients, normal.yzx));
    break;
  }
}
