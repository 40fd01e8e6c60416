// Sums over the unknowns of the fit: one vector a probe, which is a workgroup, and the sum of those in an order that
// does not depend on the device.
#ifndef RELIGHT_SUMS_GLSL
#define RELIGHT_SUMS_GLSL

#include "relight_set.glsl"

// Which of the sums: the norms of two steps take turns.
const uint SUM_STEEPNESS = 2u;

shared vec3 lanes[OLX_RELIGHT_GROUP];

vec3 sum_of_group(vec3 x) {
  barrier(); // the sum before may still be read
  lanes[gl_LocalInvocationIndex] = x;
  for (uint count = OLX_RELIGHT_GROUP / 2u; count > 0u; count /= 2u) {
    barrier();
    if (gl_LocalInvocationIndex < count) lanes[gl_LocalInvocationIndex] += lanes[gl_LocalInvocationIndex + count];
  }
  barrier();
  return lanes[0];
}

void write_partial(uint sum, vec3 x) {
  vec3 total = sum_of_group(x);
  if (gl_LocalInvocationIndex == 0u) set_state(relight.partial + 3u * (relight.probes * sum + gl_WorkGroupID.x), total);
}

// The whole of a sum that the pass before has written.
vec3 read_sum(uint sum) {
  vec3 x = vec3(0.0);
  for (uint i = gl_LocalInvocationIndex; i < relight.probes; i += OLX_RELIGHT_GROUP) {
    x += state_vector(relight.partial + 3u * (relight.probes * sum + i));
  }
  return sum_of_group(x);
}

float ratio(float a, float b) { return b > 0.0 ? a / b : 0.0; }
vec3 ratios(vec3 a, vec3 b) { return vec3(ratio(a.x, b.x), ratio(a.y, b.y), ratio(a.z, b.z)); }

#endif
