// Maps of irradiance at scheduled probes: the sum over cells of what their surfaces send.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "relight_set.glsl"

shared float cell_light[3 * 32 * 32];

// Every workgroup of a probe sums all of its cells.
void sum_cells(uint probe) {
  uint n = relight.size, cells = relight.cells, per_cell = n / cells;
  for (uint c = gl_LocalInvocationIndex; c < cells * cells; c += OLX_RELIGHT_GROUP) {
    uvec2 corner = uvec2(c % cells, c / cells) * per_cell;
    vec3 sum = vec3(0.0);
    for (uint k = 0u; k < per_cell * per_cell; k++) {
      uint i = (corner.y + k / per_cell) * n + corner.x + k % per_cell;
      sum += radiance_vector(3u * (n * n * probe + i)) * uintBitsToFloat(state[relight.shares + i]);
    }
    cell_light[3u * c] = sum.x;
    cell_light[3u * c + 1u] = sum.y;
    cell_light[3u * c + 2u] = sum.z;
  }
}

// Radiance times cosine, weights brought to pi.
vec3 gather(vec3 direction) {
  float weight = 0.0;
  vec3 sum = vec3(0.0);
  for (uint c = 0u; c < relight.cells * relight.cells; c++) {
    float w = max(olx_dot(direction, state_vector(relight.moments + 3u * c)), 0.0);
    weight += w;
    sum += vec3(cell_light[3u * c], cell_light[3u * c + 1u], cell_light[3u * c + 2u]) * w;
  }
  return sum * (OLX_PI / weight);
}

void main() {
  relight_job job = read_job(relight.jobs, gl_WorkGroupID.y);
  sum_cells(job.probe);
  barrier();
  uint n = relight.map_size, texel = gl_GlobalInvocationID.x;
  if (texel >= n * n) return;
  vec3 fresh = gather(olx_texel_direction(uvec2(texel % n, texel / n), n));
  uint at = relight.exact + 3u * (n * n * job.probe + texel);
  set_state(at, fresh + (state_vector(at) - fresh) * job.history);
}
