// Computes the irradiance of probes of the volume whose turn it is, cyclically from call.first on, from the surfels of
// their links.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "relight_set.glsl"

layout(set = 0, binding = OLX_BINDING_VOLUME_LIGHT, std430) buffer volume_light_block { uint volume_light[]; };

void add_link(uint link, inout vec3 sums[OLX_HARMONICS_MOST]) {
  vec3 light = olx_rgb9e5_unpack(structure[link + 1u]) * state_vector(relight.values + 3u * structure[link]);
  vec2 at = vec2(structure[link + 2u] & 0xFFFFu, structure[link + 2u] >> 16) / 65535.0;
  float values[OLX_HARMONICS_MOST];
  olx_harmonics_at(olx_octahedral_decode(at), values);
  for (uint k = 0u; k < OLX_HARMONICS_MOST; k++) sums[k] += light * values[k];
}

void write_probe(uint probe, vec3 sums[OLX_HARMONICS_MOST]) {
  uint halves[OLX_VOLUME_HALVES];
  halves[OLX_VOLUME_HALVES - 1u] = 0u;
  for (uint k = 0u; k < OLX_HARMONICS_MOST; k++) {
    vec3 c = sums[k] * olx_irradiance_scale(k);
    if (k == 0u) c = max(c, vec3(0.0)); // ringing may make the mean of zero light slightly negative
    for (uint i = 0u; i < 3u; i++) halves[3u * k + i] = olx_half_pack_finite(c[i]);
  }
  const uint words = OLX_VOLUME_HALVES / 2u;
  uint first = relight.volume_light + words * probe;
  for (uint i = 0u; i < words; i++) volume_light[first + i] = halves[2u * i] | halves[2u * i + 1u] << 16;
}

void main() {
  uint thread = thread_index();
  if (thread >= call.count) return;
  uint probe = (call.first + thread) % relight.volume_probes, end = structure[relight.volume_starts + probe + 1u];
  vec3 sums[OLX_HARMONICS_MOST];
  for (uint k = 0u; k < OLX_HARMONICS_MOST; k++) sums[k] = vec3(0.0);
  for (uint i = structure[relight.volume_starts + probe]; i < end; i++) add_link(relight.volume_links + 3u * i, sums);
  write_probe(probe, sums);
}
