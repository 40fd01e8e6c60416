// Twin of src/block/geometry_block.h: the planes that 4 x 4 texels see, in 16 bytes. A plane is the set of points p,
// relative to the probe, with m . p = 1; zeros are the sky.
//
// SPDX-License-Identifier: MIT
#ifndef OLX_GEOMETRY_BLOCK_GLSL
#define OLX_GEOMETRY_BLOCK_GLSL

#include "../octalux_shared.h"
#include "octahedral.glsl"

// Decodes a coded plane of the block at `place`, in blocks of a map with n texels a side.
vec3 olx_plane_decode(uvec2 code, uint n, uvec2 place) {
  int a = int(code.x << 15) >> 15, b = int(code.x) >> 17, c = int(code.y << 17) >> 17;
  int side = int(n), x = 8 * int(place.x) + 4 - side, z = 8 * int(place.y) + 4 - side;
  int sign_x = x < 0 ? -1 : 1, sign_z = z < 0 ? -1 : 1;
  // This is m on the face of the octahedron where x, y and z are positive, or where x and z are positive and y is not.
  int middle = 4 * a - b * x - c * z, along_x = sign_x * b * side, along_z = sign_z * c * side;
  bool upper = sign_x * x + sign_z * z <= side;
  float scale = uintBitsToFloat((code.y >> 15 & 127u) + OLX_PLANE_EXPONENT << 23);
  precise vec3 plane = vec3(float(sign_x * (middle + along_x)),
                            float(upper ? middle : -(middle + along_x + along_z)),
                            float(sign_z * (middle + along_z))) * scale;
  return plane;
}

// Returns the number of a texel's plane in the pool, for a block that refers to the pool; else OLX_NO_PLANE. Texels
// count row by row.
uint olx_geometry_pooled(uvec4 block, uint texel) {
  bool pooled = block.w >> 30 == OLX_GEOMETRY_POOL;
  return pooled ? block.x + ((texel < 8u ? block.y : block.z) >> 4u * (texel & 7u) & 15u) : OLX_NO_PLANE;
}

// Returns the plane that a texel sees; `pooled` is the plane numbered by olx_geometry_pooled, or zeros.
vec3 olx_geometry_plane_of(uvec4 block, uvec2 pooled, uint n, uvec2 place, uint texel) {
  uint mode = block.w >> 30;
  bool second = ((texel < 8u ? block.z : block.w) >> 22u + (texel & 7u) & 1u) != 0u;
  if (mode == OLX_GEOMETRY_TWO) pooled = second ? block.yw : block.xz;
  vec3 plane = uintBitsToFloat(block.xyz);
  if (mode != OLX_GEOMETRY_ONE) plane = olx_plane_decode(pooled, n, place);
  return plane;
}

// Returns a bound of a block with planes in the pool: no point that its texels see has a greater inverse depth.
float olx_geometry_nearest(uvec4 block) { return uintBitsToFloat(block.w << 2 >> 1); }

// Returns a value below 1 in front of the plane, 1 on it, and above 1 behind it.
float olx_plane_depth(vec3 plane, vec3 point) { return olx_dot(plane, point); }

// Returns the unit normal on the probe's side; 0 for the sky.
vec3 olx_plane_normal(vec3 plane) { return olx_normalize(-plane); }

// Returns the distance to the plane along a unit direction; infinite where the plane is not met.
float olx_plane_distance(vec3 plane, vec3 direction) {
  float inverse = olx_dot(plane, direction);
  return inverse > 0.0 ? 1.0 / inverse : OLX_INFINITY;
}

// Returns the point of the octahedron in the middle of a block's texel.
vec3 olx_block_texel_point(uint n, uvec2 place, uint texel) {
  uvec2 at = OLX_BLOCK_SIDE * place + uvec2(texel % OLX_BLOCK_SIDE, texel / OLX_BLOCK_SIDE);
  precise vec2 uv = (vec2(at) + 0.5) * (1.0 / float(n));
  return olx_octahedral_point(uv);
}

#endif
