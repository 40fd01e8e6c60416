// A step of conjugate gradients: along the direction, and then another direction.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "relight_sums.glsl"

void main() {
  uint offset = 3u * gl_GlobalInvocationID.x, gradient_at = relight.gradient + offset;
  vec3 direction = state_vector(relight.direction + offset), gradient = state_vector(gradient_at);
  if (call.kind == OLX_FIT_ADVANCE) {
    vec3 length = ratios(read_sum(call.norm), read_sum(SUM_STEEPNESS));
    set_state(relight.solution + offset, state_vector(relight.solution + offset) + direction * length);
    gradient -= state_vector(relight.product + offset) * length;
    set_state(gradient_at, gradient);
    write_partial(1u - call.norm, gradient * gradient);
  } else {
    vec3 keep = ratios(read_sum(1u - call.norm), read_sum(call.norm));
    set_state(relight.direction + offset, gradient + direction * keep);
  }
}
