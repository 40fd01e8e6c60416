// Texels of light field maps, as the passes of a relighter see them.
#ifndef RELIGHT_TEXEL_GLSL
#define RELIGHT_TEXEL_GLSL

#include "relight_set.glsl"
#include "../lib/maps.glsl"

// Of the whole map: texel i of a job's tile.
uvec2 tile_texel(relight_job job, uint i) {
  uint side = relight.tile_side, tiles = olx_field.n / side;
  return uvec2(job.tile % tiles, job.tile / tiles) * side + uvec2(i % side, i / side);
}

// What shines or is sky has no place that is lit.
olx_surface_view view_texel(relight_job job, uvec2 texel) {
  ivec3 map = olx_map_origin(job.probe);
  uint stride = olx_field.n + 2u, index = (texel.y + 1u) * stride + texel.x + 1u;
  uint normal_bits = texelFetch(olx_normal_maps, map + ivec3(texel, 0), 0).r;
  return view_of(job.position, olx_texel_direction(texel, olx_field.n), normal_bits,
                 olx_texel_distance_bits(map, ivec2(texel)), places[stride * stride * job.probe + index]);
}

#endif
