// Interpolates the indirect light of texels of scheduled tiles from the surfels of their blocks' sites.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "relight_tile.glsl"

// Returns the site of a texel, or OLX_RELIGHT_NO_SITE.
uint site_of(uint probe, uvec2 texel) {
  uint side = olx_field.n / OLX_RELIGHT_BLOCK;
  uvec2 block = texel / OLX_RELIGHT_BLOCK, within = texel % OLX_RELIGHT_BLOCK;
  uint at = 2u * (side * side * probe + block.y * side + block.x), first = structure[at];
  uint which = structure[at + 1u] >> 2u * (within.y * OLX_RELIGHT_BLOCK + within.x) & 3u;
  return first == OLX_RELIGHT_NO_SITE ? first : first + which;
}

vec3 interpolated(uint site, uvec2 texel) {
  uint end = structure[relight.entry_starts + site + 1u];
  vec4 corners = olx_site_corners(texel % OLX_RELIGHT_BLOCK);
  vec3 sum = vec3(0.0);
  for (uint i = structure[relight.entry_starts + site]; i < end; i++) {
    uint entry = relight.entries + 2u * i;
    sum += state_vector(relight.irradiance + 3u * structure[entry]) * olx_site_weight(structure[entry + 1u], corners);
  }
  return sum;
}

void main() {
  uint thread = thread_index(), slot = thread / texels_a_tile();
  if (thread >= call.count) return;
  relight_tile tile = read_tile(slot);
  uvec2 texel = tile.first + olx_tile_texel(thread % texels_a_tile(), relight.tile_side);
  uint site = site_of(tile.probe, texel);
  vec3 light = vec3(0.0); // also for the sky
  if (site != OLX_RELIGHT_NO_SITE && !olx_texel_is_sky(olx_map_origin(tile.probe), ivec2(texel))) {
    light = interpolated(site, texel);
  }
  write_texel(relight.tile_indirect, slot, texel, olx_rgb9e5_pack(light));
}
