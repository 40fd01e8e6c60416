// Twin of src/field/texels.h: reads what a texel of a light field probe holds of the surface that it sees. Its distance
// and its normal are read by maps.glsl.
#ifndef OLX_TEXELS_GLSL
#define OLX_TEXELS_GLSL

#include "bsdf.glsl"
#include "maps.glsl"

const uint OLX_EMISSION_TILE = 8u; // texels along a side of a tile of emission

// How the surface reflects; that of the sky reflects nothing through its diffuse lobe. Texture units make shares of the
// bytes.
olx_bsdf olx_texel_material(ivec3 origin, ivec2 texel) {
  vec4 base = texelFetch(olx_base_maps, origin + ivec3(texel, 0), 0);
  vec2 specular = texelFetch(olx_specular_maps, origin + ivec3(texel, 0), 0).rg;
  return olx_bsdf_make(base.rgb * base.rgb, specular.r, base.a, specular.g);
}

// Irradiance in W/m^2 that reaches the surface straight from emitters and the sky; 0 for the sky.
vec3 olx_texel_direct(ivec3 origin, ivec2 texel) {
  return texelFetch(olx_direct_maps, origin + ivec3(texel, 0), 0).rgb;
}

// Irradiance in W/m^2 of light that has at least one surface between emitter and texel; 0 for the sky.
vec3 olx_texel_indirect(ivec3 origin, ivec2 texel) {
  return texelFetch(olx_indirect_maps, origin + ivec3(texel, 0), 0).rgb;
}

// Radiance in W/(sr m^2) that an emitter sends towards the probe, or that of the sky; 0 for a surface that does not emit.
// The texel is none of the border.
vec3 olx_texel_emission(uint probe, ivec2 texel) {
  vec3 emission = vec3(0.0);
  if (olx_texel_distance_bits(olx_map_origin(probe), texel) >= 0x7C00u) {
    uvec2 at = uvec2(texel), tile = at / OLX_EMISSION_TILE, inside = at % OLX_EMISSION_TILE;
    uint side = olx_field.tile_side;
    uint entry = olx_words[olx_field.emission_first + side * side * probe + tile.y * side + tile.x];
    uint first = olx_field.tiles_first + (entry - 1u) * OLX_EMISSION_TILE * OLX_EMISSION_TILE;
    if (entry != 0u && entry <= olx_field.tile_count) { // a damaged file may name what there is not
      emission = olx_rgb9e5_unpack(olx_words[first + inside.y * OLX_EMISSION_TILE + inside.x]);
    }
  }
  return emission;
}

#endif
