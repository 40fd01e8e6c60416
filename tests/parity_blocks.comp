// Rows of geometry blocks: a dispatch computes one row, a thread one item.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "parity_rows.h"
#include "shaders/lib/geometry_block.glsl"

layout(local_size_x = 64) in;
layout(push_constant) uniform row_block { uint row; };

struct block_item {
  uvec4 block;
  uvec4 pooled; // the code of a plane, and a texel
  uvec4 place; // x: n; yz: position of the block
  vec4 point;
};
layout(set = 0, binding = 0, std430) readonly buffer items_block { block_item items[]; };
layout(set = 0, binding = 1, std430) writeonly buffer results_block { uint results[]; };

uint filled = 0u;
void put(uint x) { results[gl_GlobalInvocationID.x * PARITY_RESULTS + filled++] = x; }
void put(float x) { put(floatBitsToUint(x)); }
void put(vec3 v) { put(v.x), put(v.y), put(v.z); }

void main() {
  block_item item = items[gl_GlobalInvocationID.x];
  uint n = item.place.x, texel = item.pooled.z;
  uvec2 place = item.place.yz, pooled = item.pooled.xy;
  vec3 plane = olx_geometry_plane_of(item.block, pooled, n, place, texel);
  switch (row) {
  case ROW_olx_plane_decode: put(olx_plane_decode(pooled, n, place)); break;
  case ROW_olx_geometry_pooled: put(olx_geometry_pooled(item.block, texel)); break;
  case ROW_olx_geometry_plane_of: put(plane); break;
  case ROW_olx_geometry_nearest: put(olx_geometry_nearest(item.block)); break;
  case ROW_olx_plane_depth:
    put(olx_plane_depth(plane, item.point.xyz)), put(olx_plane_depth(plane, item.point.xyz) < 1.0 ? 1u : 0u);
    break;
  case ROW_olx_plane_normal: put(olx_plane_normal(plane)); break;
  case ROW_olx_plane_distance: put(olx_plane_distance(plane, item.point.xyz)); break;
  case ROW_olx_block_texel_point: put(olx_block_texel_point(n, place, texel)); break;
  }
}
