// Maps of all probes from exact maps and corrections, and how much they have changed.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "relight_sums.glsl"

vec3 fitted(uint probe, uvec2 texel) {
  uint n = relight.map_size;
  olx_bilinear cells = olx_correction_cells_at((vec2(texel) + 0.5) / float(n));
  vec3 light = state_vector(relight.exact + 3u * (n * n * probe + texel.y * n + texel.x));
  for (uint k = 0u; k < 4u; k++) {
    light += state_vector(relight.solution + 3u * (OLX_CORRECTION_CELLS * probe + cells.texel[k])) * cells.weight[k];
  }
  return max(light, vec3(0.0));
}

void main() {
  uint probe = gl_WorkGroupID.x, n = relight.map_size, stride = n + 2u;
  float changed = 0.0, sum = 0.0;
  for (uint i = gl_LocalInvocationIndex; i < stride * stride; i += OLX_RELIGHT_GROUP) {
    ivec2 at = ivec2(i % stride, i / stride) - 1, source = olx_border_source(at, int(n));
    uint place = relight.maps + 3u * (stride * stride * probe + i);
    vec3 light = fitted(probe, uvec2(source));
    if (source == at) {
      changed += abs(olx_luminance(light - state_vector(place)));
      sum += olx_luminance(light);
    }
    set_state(place, light);
  }
  vec3 total = sum_of_group(vec3(changed, sum, 0.0));
  if (gl_LocalInvocationIndex != 0u) return;
  state[relight.changes + 2u * probe] = floatBitsToUint(total.x);
  state[relight.changes + 2u * probe + 1u] = floatBitsToUint(total.y / float(n * n));
}
