// What corrections say at points: of the solution, taken with exact maps from what was measured, or of a direction.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "relight_set.glsl"

const uint NO_POINT = 0xFFFFFFFFu;

vec3 correction_at(uint corrections, uint probe, olx_bilinear cells) {
  vec3 sum = vec3(0.0);
  for (uint k = 0u; k < 4u; k++) {
    sum += state_vector(corrections + 3u * (OLX_CORRECTION_CELLS * probe + cells.texel[k])) * cells.weight[k];
  }
  return sum;
}

vec3 exact_at(uint probe, olx_bilinear texels) {
  uint map = relight.exact + 3u * relight.map_size * relight.map_size * probe;
  vec3 sum = vec3(0.0);
  for (uint k = 0u; k < 4u; k++) sum += state_vector(map + 3u * texels.texel[k]) * texels.weight[k];
  return sum;
}

void main() {
  if (gl_GlobalInvocationID.x >= relight.points) return;
  uint point = relight.points * gl_WorkGroupID.y + gl_GlobalInvocationID.x;
  uint normal = fit[(4u + relight.rays) * point + 3u];
  if (normal == NO_POINT) return;
  bool residual = call.kind == OLX_FIT_RESIDUAL;
  vec2 uv = olx_octahedral_encode(olx_normal_unpack(normal));
  olx_bilinear cells = olx_correction_cells_at(uv);
  olx_bilinear texels = olx_without_border(olx_bilinear_at(uv, relight.map_size), relight.map_size);
  vec3 known = vec3(0.0);
  for (uint tap = fit[relight.tap_starts + point]; tap < fit[relight.tap_starts + point + 1u]; tap++) {
    uint probe = fit[relight.taps + 2u * tap];
    vec3 light = correction_at(residual ? relight.solution : relight.direction, probe, cells);
    if (residual) light += exact_at(probe, texels);
    known += light * uintBitsToFloat(fit[relight.taps + 2u * tap + 1u]);
  }
  set_state(relight.value + 3u * point, residual ? state_vector(relight.measured + 3u * point) - known : known);
}
