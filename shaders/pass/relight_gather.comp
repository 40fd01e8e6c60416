// What points' values are to the unknowns, with the penalties: the first gradient, or the product with a direction.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "relight_sums.glsl"

vec3 unknown_of(uint vectors, uint cell) {
  return state_vector(vectors + 3u * (OLX_CORRECTION_CELLS * gl_WorkGroupID.x + cell));
}

vec3 sum_points(uint unknown) {
  vec3 sum = vec3(0.0);
  for (uint k = fit[relight.list_starts + unknown]; k < fit[relight.list_starts + unknown + 1u]; k++) {
    uint entry = relight.list + 2u * k;
    sum += state_vector(relight.value + 3u * fit[entry]) * uintBitsToFloat(fit[entry + 1u]);
  }
  return sum;
}

// On a correction's size and on its differences between neighbouring cells.
vec3 penalty(uint vectors, uint cell) {
  uint neighbours[6], count = olx_correction_neighbours(cell, neighbours);
  vec3 own = unknown_of(vectors, cell), sum = own * OLX_SIZE_PENALTY;
  for (uint k = 0u; k < count; k++) sum += (own - unknown_of(vectors, neighbours[k])) * OLX_SMOOTHNESS_PENALTY;
  return sum * float(relight.points);
}

void main() {
  uint cell = gl_LocalInvocationIndex, unknown = OLX_CORRECTION_CELLS * gl_WorkGroupID.x + cell;
  if (call.kind == OLX_FIT_RESIDUAL) {
    vec3 gradient = sum_points(unknown) - penalty(relight.solution, cell);
    set_state(relight.gradient + 3u * unknown, gradient);
    set_state(relight.direction + 3u * unknown, gradient);
    write_partial(0u, gradient * gradient);
  } else {
    vec3 product = sum_points(unknown) + penalty(relight.direction, cell);
    set_state(relight.product + 3u * unknown, product);
    write_partial(SUM_STEEPNESS, product * unknown_of(relight.direction, cell));
  }
}
