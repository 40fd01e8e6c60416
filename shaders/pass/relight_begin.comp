// Direct light of surfaces and texels begins anew, before rays add to it. That of lights with an area is the mean over
// a probe's updates since lights changed.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "relight_set.glsl"

void begin_surface(relight_job job, uint i) {
  uint offset = 3u * (surfaces_a_probe() * job.probe + i), varying_at = relight.varying_light + offset;
  if ((job.flags & OLX_JOB_FIXED) != 0u) {
    set_places(relight.fixed_light + offset, vec3(0.0));
    set_places(varying_at, vec3(0.0));
  } else if ((job.flags & OLX_JOB_VARYING) != 0u) {
    set_places(varying_at, places_vector(varying_at) * (float(job.rounds) / float(job.rounds + 1u)));
  }
}

void main() {
  uint i = gl_GlobalInvocationID.x, slot = gl_WorkGroupID.y, texels = relight.tile_side * relight.tile_side;
  if (call.kind == OLX_RELIGHT_TEXELS) {
    if (i < texels) set_places(relight.tile_light + 3u * (texels * slot + i), vec3(0.0));
  } else if (i < surfaces_a_probe()) {
    begin_surface(read_job(relight.jobs, slot), i);
  }
}
