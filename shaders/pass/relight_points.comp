// Irradiance at the points of scheduled probes, from the surfaces that their rays meet.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "relight_set.glsl"

// What no probe sees lies in hollows: it sends this share of what the rest does on average.
const float UNSEEN_SHARE = 0.5;
const uint NO_POINT = 0xFFFFFFFFu, RAY_SKY = 0xFFFFFFFFu, RAY_UNKNOWN = 0xFFFFFFFEu;

void main() {
  relight_job job = read_job(relight.jobs, gl_WorkGroupID.y);
  if (gl_GlobalInvocationID.x >= relight.points) return;
  uint point = relight.points * job.probe + gl_GlobalInvocationID.x, record = (4u + relight.rays) * point;
  if (fit[record + 3u] == NO_POINT) return;
  vec3 sum = vec3(0.0);
  uint known = 0u;
  for (uint k = 0u; k < relight.rays; k++) {
    uint ray = fit[record + 4u + k];
    if (ray == RAY_UNKNOWN) continue;
    known++;
    if (ray != RAY_SKY) sum += radiance_vector(3u * ray);
  }
  float unseen = UNSEEN_SHARE * float(relight.rays - known);
  float share = known > 0u ? (float(known) + unseen) / float(known) : 0.0;
  set_state(relight.measured + 3u * point, sum * (share * OLX_PI / float(relight.rays)));
}
