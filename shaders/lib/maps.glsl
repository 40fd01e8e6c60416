// Twin of src/field/maps.h: reading the maps of a field. Texels are counted without the border.
#ifndef OLX_MAPS_GLSL
#define OLX_MAPS_GLSL

#include "data.glsl"
#include "pack.glsl"

// Where the map of a probe begins in its image: x, y and layer.
ivec3 olx_map_corner(uint probe, uint stride, uint maps_a_side) {
  uint maps_a_layer = maps_a_side * maps_a_side, map = probe % maps_a_layer;
  return ivec3(map % maps_a_side * stride, map / maps_a_side * stride, probe / maps_a_layer);
}

// Texel (0, 0) of a probe's light field maps, within their border.
ivec3 olx_map_origin(uint probe) {
  return olx_map_corner(probe, olx_field.n + 2u, olx_field.maps_a_side) + ivec3(1, 1, 0);
}

// The texel of a light field map that a direction falls into.
ivec2 olx_texel_towards(vec3 direction) {
  precise vec2 texel = olx_octahedral_encode(direction) * float(olx_field.n);
  return ivec2(min(texel, float(olx_field.n) - 1.0));
}

// The stored half float: its sign bit marks emitters.
uint olx_texel_distance_bits(ivec3 origin, ivec2 texel) {
  return texelFetch(olx_distance_maps, origin + ivec3(texel, 0), 0).r;
}

// Stored distance of a texel in metres; infinite for the sky.
float olx_texel_distance(ivec3 origin, ivec2 texel) {
  precise float distance = olx_half_unpack(olx_texel_distance_bits(origin, texel) & 0x7FFFu) * olx_field.distance_scale;
  return distance;
}

bool olx_texel_emits(ivec3 origin, ivec2 texel) { return (olx_texel_distance_bits(origin, texel) & 0x8000u) != 0u; }

vec3 olx_texel_normal(ivec3 origin, ivec2 texel) {
  return olx_normal_unpack(texelFetch(olx_normal_maps, origin + ivec3(texel, 0), 0).r);
}

vec3 olx_texel_radiance(ivec3 origin, ivec2 texel) {
  return olx_radiance_texel(origin + ivec3(texel, 0));
}

// Where a direction's octahedral coordinates lie in the images of irradiance and moments.
vec3 olx_irradiance_coordinate(uint probe, vec2 uv) {
  ivec3 corner = olx_map_corner(probe, olx_field.irradiance_n + 2u, olx_field.irradiance_maps_a_side);
  return vec3((vec2(corner.xy) + 1.0 + uv * float(olx_field.irradiance_n)) * olx_field.irradiance_texel, corner.z);
}

#endif
