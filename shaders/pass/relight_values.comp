// Computes what each surfel sends over its links: its direct plus indirect irradiance.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "relight_set.glsl"

void main() {
  uint thread = thread_index(), at = 3u * thread;
  if (thread >= call.count) return;
  set_state(relight.values + at, state_vector(relight.direct + at) + state_vector(relight.irradiance + at));
}
