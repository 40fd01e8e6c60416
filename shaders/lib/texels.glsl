// Twin of src/field/texels.h: reads what a texel of a light field probe stores of the surface that it sees. maps.glsl
// reads its distance and normal. For the sky, only emission is defined.
//
// SPDX-License-Identifier: MIT
#ifndef OLX_TEXELS_GLSL
#define OLX_TEXELS_GLSL

#include "bsdf.glsl"
#include "maps.glsl"


// Returns the place of a texel in the image of one kind of maps of surfaces, for the probe whose maps begin at
// `origin`: among texels, or in the image of a pool. `words` is the first word of the kind's tiles, `count` the number
// of blocks in its pool. The layer is -1 for a tile of sky, and where a damaged file names blocks that do not exist.
// The texel must not be of the border, here and in the functions below.
ivec3 olx_surface_at(ivec3 origin, ivec2 texel, uint words, uint count) {
  ivec2 map = ivec2(vec2(origin.xy - 1) * olx_field.map_scale + 0.5);
  uint along = olx_field.maps_a_side, probe = (uint(origin.z) * along + uint(map.y)) * along + uint(map.x);
  uvec2 at = uvec2(texel), tile = at / OLX_TILE_SIDE;
  uint side = olx_field.tile_side, word = 0u;
  if (olx_field.tiled != 0u) word = olx_word(words + (side * probe + tile.y) * side + tile.x);
  uint form = word >> OLX_TILE_FORM_SHIFT, block = word & ((1u << OLX_TILE_FORM_SHIFT) - 1u);
  bool halved = form == OLX_TILE_HALF;
  if (!halved) block += (at.y >> 1 & 2u) + (at.x >> 2 & 1u);
  uvec2 within = (halved ? at >> 1u : at) & 3u;
  const uint row = (1u << OLX_POOL_ROW_BITS) - 1u;
  uvec2 corner = uvec2(block & row, block >> OLX_POOL_ROW_BITS & row) * OLX_BLOCK_SIDE;
  bool none = form == 0u || block >= count;
  ivec3 place = ivec3(ivec2(corner + within), none ? -1 : int(block >> 2u * OLX_POOL_ROW_BITS));
  if (olx_field.tiled == 0u) place = origin + ivec3(texel, 0);
  return place;
}

// Returns the reflectance of the texel's surface. Texture units convert bytes to shares. A field of tiles has
// reflectance in one byte, as src/block/reflectance.h packs it, and roughness in another.
olx_bsdf olx_texel_material(ivec3 origin, ivec2 texel) {
  ivec3 base_at = olx_surface_at(origin, texel, olx_field.tile_words.x, olx_field.tile_blocks.x);
  ivec3 specular_at = olx_surface_at(origin, texel, olx_field.tile_words.y, olx_field.tile_blocks.y);
  vec4 base = base_at.z < 0 ? vec4(0.0) : texelFetch(olx_base_maps, base_at, 0);
  vec2 specular = specular_at.z < 0 ? vec2(0.0) : texelFetch(olx_specular_maps, specular_at, 0).rg;
  bool packed = olx_field.compressed != 0u;
  float code = specular.g * 255.0;
  float metallic =
      packed ? max((code - OLX_REFLECTANCE_FULL) * (1.0 / (255.0 - OLX_REFLECTANCE_FULL)), 0.0) : specular.r;
  float roughness = packed ? specular.r : base.a;
  float weight = packed ? min(code * (1.0 / OLX_REFLECTANCE_FULL), 1.0) : specular.g;
  return olx_bsdf_make(base.rgb * base.rgb, metallic, roughness, weight);
}

// Returns the irradiance in W/m^2 that reaches the surface directly from emitters and the sky.
vec3 olx_texel_direct(ivec3 origin, ivec2 texel) {
  ivec3 at = olx_surface_at(origin, texel, olx_field.tile_words.z, olx_field.tile_blocks.z);
  return at.z < 0 ? vec3(0.0) : texelFetch(olx_direct_maps, at, 0).rgb;
}

// Returns the irradiance in W/m^2 of light that met at least one surface between emitter and texel.
vec3 olx_texel_indirect(ivec3 origin, ivec2 texel) {
  ivec3 at = olx_surface_at(origin, texel, olx_field.tile_words.w, olx_field.tile_blocks.w);
  return at.z < 0 ? vec3(0.0) : texelFetch(olx_indirect_maps, at, 0).rgb;
}

// Returns the emission stored for a texel, not of the border, RGB9E5; 0 where nothing emits.
uint olx_texel_emission_code(uint probe, ivec2 texel) {
  uvec2 at = uvec2(texel), tile = at / OLX_EMISSION_TILE, inside = at % OLX_EMISSION_TILE;
  uint side = olx_field.tile_side;
  uint entry = olx_word(olx_field.emission_first + side * side * probe + tile.y * side + tile.x);
  uint first = olx_field.tiles_first + (entry - 1u) * OLX_EMISSION_TILE * OLX_EMISSION_TILE, code = 0u;
  // A damaged file may name a tile that does not exist.
  if (entry != 0u && entry <= olx_field.tile_count) code = olx_word(first + inside.y * OLX_EMISSION_TILE + inside.x);
  return code;
}

// Returns whether the texel, not of the border, sees an emitter. The sky does not count as one.
bool olx_texel_emits(uint probe, ivec2 texel) {
  ivec3 origin = olx_map_origin(probe);
  if (!olx_geometry_in_blocks()) return (olx_texel_distance_bits(origin, texel) & 0x8000u) != 0u;
  return olx_texel_emission_code(probe, texel) != 0u && !olx_texel_is_sky(origin, texel);
}

// Returns the radiance in W/(sr m^2) that an emitter sends towards the probe, or that of the sky; 0 for a surface that
// does not emit. The texel must not be of the border.
vec3 olx_texel_emission(uint probe, ivec2 texel) {
  bool may = olx_geometry_in_blocks() || olx_texel_distance_bits(olx_map_origin(probe), texel) >= 0x7C00u;
  return may ? olx_rgb9e5_unpack(olx_texel_emission_code(probe, texel)) : vec3(0.0);
}

#endif
