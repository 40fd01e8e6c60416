// Maps in the form and size that the field has them in, with their border.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "relight_set.glsl"

void main() {
  uint n = relight.irradiance_n, stride = n + 2u, i = gl_GlobalInvocationID.x;
  if (i >= stride * stride) return;
  uint probe = state[relight.packs + gl_WorkGroupID.y];
  ivec2 source = olx_border_source(ivec2(i % stride, i / stride) - 1, int(n));
  olx_bilinear taps = olx_bilinear_at((vec2(source) + 0.5) / float(n), relight.map_size);
  uint map = relight.maps + 3u * (relight.map_size + 2u) * (relight.map_size + 2u) * probe;
  vec3 sum = vec3(0.0);
  for (uint k = 0u; k < 4u; k++) sum += state_vector(map + 3u * taps.texel[k]) * taps.weight[k];
  packed_maps[stride * stride * probe + i] = olx_r11g11b10f_pack(sum);
}
