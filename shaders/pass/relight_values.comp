// Computes what each surfel sends over its links: its direct plus indirect irradiance; or, for the volume, that with
// the light of lamps close by.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "relight_set.glsl"

void main() {
  uint thread = thread_index(), at = 3u * thread;
  if (thread >= call.count) return;
  vec3 light = state_vector(relight.direct + at) + state_vector(relight.irradiance + at);
  if ((call.flags & OLX_CALL_ALL) != 0u) light += state_vector(relight.close + at);
  set_state(relight.values + at, light);
}
