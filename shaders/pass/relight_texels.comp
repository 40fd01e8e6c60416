// Adds one sample of direct light to the running mean of each texel of scheduled tiles.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "relight_rays.glsl"
#include "relight_tile.glsl"

// Returns the place of texel i of a tile. Random numbers are stratified over a block of neighbours.
lit_place texel_place(relight_tile tile, uvec2 texel, uint i) {
  const uint neighbours = OLX_LIT_SIDE * OLX_LIT_SIDE;
  ivec3 map = olx_map_origin(tile.probe);
  olx_texel_geometry seen = olx_texel_geometry_of(map, ivec2(texel));
  float distance_metres = seen.distance;
  vec3 normal = seen.normal;
  vec3 place = olx_probe_position(tile.probe) + olx_texel_direction(texel, olx_field.n) * distance_metres;
  return lit_place(
      place + normal * (OLX_OFF_SURFACE * distance_metres), normal,
      olx_hash3(tile.probe, (tile.first.y * olx_field.n + tile.first.x) * olx_field.n + i / neighbours, OLX_SALT_TEXEL),
      i % neighbours + neighbours * tile.rounds);
}

void main() {
  uint thread = thread_index(), slot = thread / texels_a_tile(), i = thread % texels_a_tile();
  if (thread >= call.count) return;
  relight_tile tile = read_tile(slot);
  uvec2 texel = tile.first + olx_tile_texel(i, relight.tile_side);
  ivec3 map = olx_map_origin(tile.probe);
  bool lit = !olx_texel_is_sky(map, ivec2(texel));
  vec3 found = vec3(0.0);
  if (lit) {
    lit_sum sum = light_place(texel_place(tile, texel, i));
    found = add_up(relight.tile_light + 3u * thread, sum.irradiance + sum.close);
  }
  if (!ends()) return;
  vec3 mean = texelFetch(olx_direct_maps, map + ivec3(texel, 0), 0).rgb;
  if (lit) mean += (found - mean) * (1.0 / float(tile.rounds + 1u));
  write_texel(relight.tile_direct, slot, texel, olx_rgb9e5_pack(mean));
}
