// Twin of src/field/maps.h: reads the maps of a field. Texels are counted without the border.
//
// SPDX-License-Identifier: MIT
#ifndef OLX_MAPS_GLSL
#define OLX_MAPS_GLSL

#include "data.glsl"
#include "geometry_block.glsl"
#include "pack.glsl"

#ifndef GL_ES
layout(constant_id = OLX_CONSTANT_GEOMETRY) const uint olx_constant_geometry = 2u; // OLX_GEOMETRY_IN_EITHER
#else
const uint olx_constant_geometry = uint(OLX_GEOMETRY_IN_EITHER);
#endif

// Returns where the map of a probe begins in its image: x, y and layer.
ivec3 olx_map_corner(uint probe, uint stride, uint maps_a_side) {
  uint maps_a_layer = maps_a_side * maps_a_side, map = probe % maps_a_layer;
  return ivec3(map % maps_a_side * stride, map / maps_a_side * stride, probe / maps_a_layer);
}

// Returns the place of texel (0, 0) of a probe's light field maps, which lies inside their border.
ivec3 olx_map_origin(uint probe) {
  return olx_map_corner(probe, olx_field.n + 2u, olx_field.maps_a_side) + ivec3(1, 1, 0);
}

// Returns the texel of a light field map into which a direction falls.
ivec2 olx_texel_towards(vec3 direction) {
  precise vec2 texel = olx_octahedral_encode(direction) * float(olx_field.n);
  return ivec2(min(texel, float(olx_field.n) - 1.0));
}

// Returns the stored half float, whose sign bit marks emitters.
uint olx_texel_distance_bits(ivec3 origin, ivec2 texel) {
  return texelFetch(olx_distance_maps, origin + ivec3(texel, 0), 0).r;
}

// Returns whether geometry is stored in blocks.
bool olx_geometry_in_blocks() {
  bool either = olx_constant_geometry == uint(OLX_GEOMETRY_IN_EITHER);
  return either ? olx_field.geometry_scale > 0.0 : olx_constant_geometry == uint(OLX_GEOMETRY_IN_BLOCKS);
}

// Reads a geometry block of the probe whose maps begin at `origin`.
uvec4 olx_geometry_block(ivec3 origin, ivec2 place) {
  ivec2 corner = ivec2(vec2(origin.xy - 1) * olx_field.geometry_scale + 0.5);
  return texelFetch(olx_distance_maps, ivec3(corner + place, origin.z), 0);
}

// Returns the plane that a texel, not of the border, sees according to its block, over its whole extent; 0 for the sky.
// A damaged file may refer to planes that do not exist.
vec3 olx_plane_in_block(uvec4 block, ivec2 at_texel) {
  uvec2 place = uvec2(at_texel) / OLX_BLOCK_SIDE, within = uvec2(at_texel) % OLX_BLOCK_SIDE;
  uint texel = within.y * OLX_BLOCK_SIDE + within.x;
  uint at = olx_geometry_pooled(block, texel), word = olx_field.planes_first + 2u * at;
  uvec2 pooled = uvec2(0u);
  if (at < olx_field.plane_count) pooled = uvec2(olx_word(word), olx_word(word + 1u));
  return olx_geometry_plane_of(block, pooled, olx_field.n, place, texel);
}

vec3 olx_block_plane(ivec3 origin, ivec2 texel) {
  return olx_plane_in_block(olx_geometry_block(origin, texel / int(OLX_BLOCK_SIDE)), texel);
}

// What a texel sees in its direction.
struct olx_texel_geometry {
  float distance; // metres; infinite for the sky
  vec3 normal;    // of the surface, on the probe's side; undefined for the sky
};

olx_texel_geometry olx_block_geometry(ivec3 origin, ivec2 texel) {
  ivec2 source = olx_border_source(texel, int(olx_field.n));
  vec3 plane = olx_block_plane(origin, source);
  return olx_texel_geometry(olx_plane_distance(plane, olx_texel_direction(uvec2(source), olx_field.n)),
                            olx_plane_normal(plane));
}

// Returns the distance of a texel's surface in metres; infinite for the sky.
float olx_texel_distance(ivec3 origin, ivec2 texel) {
  if (olx_geometry_in_blocks()) return olx_block_geometry(origin, texel).distance;
  precise float distance = olx_half_unpack(olx_texel_distance_bits(origin, texel) & 0x7FFFu) * olx_field.distance_scale;
  return distance;
}

vec3 olx_texel_normal(ivec3 origin, ivec2 texel) {
  if (olx_geometry_in_blocks()) return olx_block_geometry(origin, texel).normal;
  return olx_normal_unpack(texelFetch(olx_normal_maps, origin + ivec3(texel, 0), 0).r);
}

// Decodes the distance and the normal of a texel together.
olx_texel_geometry olx_texel_geometry_of(ivec3 origin, ivec2 texel) {
  if (olx_geometry_in_blocks()) return olx_block_geometry(origin, texel);
  return olx_texel_geometry(olx_texel_distance(origin, texel), olx_texel_normal(origin, texel));
}

bool olx_texel_is_sky(ivec3 origin, ivec2 texel) { return olx_texel_distance(origin, texel) >= OLX_INFINITY; }

vec3 olx_texel_radiance(ivec3 origin, ivec2 texel) {
  return olx_radiance_texel(origin + ivec3(texel, 0));
}

// Returns where a direction's octahedral coordinates lie in the images of irradiance and moments.
vec3 olx_irradiance_coordinate(uint probe, vec2 uv) {
  ivec3 corner = olx_map_corner(probe, olx_field.irradiance_n + 2u, olx_field.irradiance_maps_a_side);
  return vec3((vec2(corner.xy) + 1.0 + uv * float(olx_field.irradiance_n)) * olx_field.irradiance_texel, corner.z);
}

#endif
