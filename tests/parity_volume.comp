// Rows of the irradiance volume: a dispatch computes one row, a thread one item.
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

#define OLX_OWN_VOLUME
uint olx_volume_word(uint index) { return words[index]; }

#include "shaders/lib/volume_irradiance.glsl"

uint filled = 0u;
void put(uint x) { results[gl_GlobalInvocationID.x * PARITY_RESULTS + filled++] = x; }
void put(float x) { put(floatBitsToUint(x)); }
void put(vec3 v) { put(v.x), put(v.y), put(v.z); }

void main() {
  vec3 position = items[gl_GlobalInvocationID.x].position.xyz, normal = items[gl_GlobalInvocationID.x].normal.xyz;
  uint cell;
  float values[9];
  vec3 fraction;
  mat2x3 light;
  switch (row) {
  case ROW_olx_volume_find:
    put(olx_volume_find(position, cell, fraction) ? 1u : 0u), put(cell);
    for (uint i = 0u; i < 8u; i++) put(cell != 0u ? olx_volume_weight(fraction, i) : 0.0);
    break;
  case ROW_olx_volume_weight:
    for (uint i = 0u; i < 8u; i++) put(olx_volume_weight(fract(normal), i));
    break;
  case ROW_olx_volume_light: put(olx_volume_light(gl_GlobalInvocationID.x % words[10])); break;
  case ROW_olx_volume_coefficient: {
    uint first = olx_volume_light(gl_GlobalInvocationID.x % words[10]);
    for (uint k = 0u; k < 6u; k++) put(olx_volume_coefficient(first, k + 3u));
  } break;
  case ROW_olx_harmonics_at:
    olx_harmonics_at(normal, values);
    for (uint k = 0u; k < 9u; k++) put(values[k]);
    break;
  case ROW_olx_volume_probe:
    light = olx_volume_probe(gl_GlobalInvocationID.x % words[10], normal, normal.yzx);
    put(light[0]), put(light[1]);
    break;
  case ROW_olx_volume_both:
    put(olx_volume_both(position, normal, normal, normal.yzx, light) ? 1u : 0u);
    put(light[0]), put(light[1]);
    break;
  }
}
