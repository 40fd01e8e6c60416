// What surfaces and texels reflect of their direct light and of the irradiance that there is. A thread has a block of
// neighbours; those in one plane share a look-up.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "relight_texel.glsl"

// Irradiance is that of the relighter's own maps.
vec3 olx_map_irradiance(uint probe, vec2 uv) {
  uint n = relight.map_size, map = relight.maps + 3u * (n + 2u) * (n + 2u) * probe;
  olx_bilinear taps = olx_bilinear_at(uv, n);
  vec3 sum = vec3(0.0);
  for (uint k = 0u; k < 4u; k++) sum += state_vector(map + 3u * taps.texel[k]) * taps.weight[k];
  return sum;
}

#define OLX_OWN_MAPS
#include "../lib/irradiance.glsl"

// Irradiance at a place; `leader` is the one of the block for which it was last looked up.
vec3 shared_irradiance(olx_surface_view v, inout olx_surface_view leader, inout vec3 irradiance) {
  if (leader.distance_metres >= OLX_INFINITY || !olx_alike(leader, v)) {
    irradiance = olx_irradiance(olx_sample_settings_default(), v.place, v.normal, v.view);
    leader = v;
  }
  return irradiance;
}

// Words of a tile: its texels, then what it determines of the map's border: a strip for each edge that repeats the top,
// bottom, left and right, and the corners.
void write_texel(uint tile, uvec2 texel, uint code) {
  uint side = relight.tile_side, first = relight.tile_packed + tile * (side * side + OLX_RELIT_TILE_BORDER);
  uvec2 within = texel % side;
  places[first + within.y * side + within.x] = code;
  uint strips = first + side * side, last = olx_field.n - 1u;
  // The border repeats an edge backwards.
  if (texel.y == 0u) places[strips + side - 1u - within.x] = code;
  if (texel.y == last) places[strips + side + side - 1u - within.x] = code;
  if (texel.x == 0u) places[strips + 2u * side + side - 1u - within.y] = code;
  if (texel.x == last) places[strips + 3u * side + side - 1u - within.y] = code;
  if ((texel.x == 0u || texel.x == last) && (texel.y == 0u || texel.y == last)) {
    places[strips + 4u * side + uint(texel.y != 0u) * 2u + uint(texel.x != 0u)] = code;
  }
}

void write_surface(uint at, vec3 sent) {
  radiance[at] = sent.x;
  radiance[at + 1u] = sent.y;
  radiance[at + 2u] = sent.z;
}

void main() {
  bool texels = call.kind == OLX_RELIGHT_TEXELS;
  uint block = gl_GlobalInvocationID.x, slot = gl_WorkGroupID.y, side = texels ? 4u : 2u,
       n = texels ? relight.tile_side : relight.size;
  if (side * side * block >= n * n) return;
  relight_job job = read_job(texels ? relight.tiles : relight.jobs, slot);
  olx_surface_view leader;
  leader.distance_metres = OLX_INFINITY;
  vec3 irradiance = vec3(0.0);
  for (uint k = 0u; k < side * side; k++) {
    uint i = olx_block_texel(block, k, side, n);
    uint surface = 3u * (n * n * job.probe + i); // of surfaces
    uvec2 texel = uvec2(0u);
    olx_surface_view v;
    vec3 direct, sent = vec3(0.0);
    if (texels) {
      texel = tile_texel(job, i);
      v = view_texel(job, texel);
      direct = places_vector(relight.tile_light + 3u * (n * n * slot + i));
      sent = olx_texel_radiance(olx_map_origin(job.probe), ivec2(texel)); // what shines or is sky stays as it is
    } else {
      v = view_surface(job, i);
      direct = places_vector(relight.fixed_light + surface) + places_vector(relight.varying_light + surface);
    }
    if (v.distance_metres < OLX_INFINITY) {
      sent = v.albedo * (shared_irradiance(v, leader, irradiance) + direct) * (1.0 / OLX_PI);
    }
    if (texels) write_texel(slot, texel, olx_r11g11b10f_pack(sent));
    else write_surface(surface, sent);
  }
}
