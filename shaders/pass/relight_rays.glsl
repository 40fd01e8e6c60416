// Computes direct light with shadows, by a few rays of each place in one dispatch, because some devices limit a
// dispatch's time. The sum of rays is stored in the state between dispatches.
#ifndef RELIGHT_RAYS_GLSL
#define RELIGHT_RAYS_GLSL

#include "relight_set.glsl"
#include "../lib/trace.glsl"

// A place to be lit, slightly off its surface, and the seeds of its random numbers.
struct lit_place {
  vec3 position, normal;
  uint seed, sequence;
};

olx_gpu_light read_light(uint index) {
  uint at = relight.lights + OLX_LIGHT_WORDS * index;
  return olx_gpu_light(vec4(state_vector(at), 0.0), vec4(state_vector(at + 4u), 0.0), vec4(state_vector(at + 8u), 0.0),
                       vec4(state_vector(at + 12u), 0.0), state[at + 16u], state[at + 17u],
                       uintBitsToFloat(state[at + 18u]), uintBitsToFloat(state[at + 19u]));
}

// The direct light at a place: irradiance, and its luminance by lights without area, along the way to them.
struct lit_sum {
  vec3 irradiance, beam;
};

// Returns the light of one ray. An unresolved ray counts as shadowed.
lit_sum light_along(lit_place p, olx_gpu_light light, uint index, uint light_sample, uint samples) {
  vec2 random = vec2(0.0);
  uint seed = olx_hash3(p.seed, index, OLX_SALT_LIGHT);
  if (samples > 0u) random = olx_stratified2(p.sequence * samples + light_sample, seed);
  olx_light_ray ray;
  lit_sum found = lit_sum(vec3(0.0), vec3(0.0));
  if (olx_aim(light, p.position, p.normal, random, ray)) {
    olx_trace_hit hit = olx_trace(olx_sample_settings_default(), p.position, ray.direction, ray.length_metres);
    if (hit.status == OLX_TRACE_MISS) {
      found.irradiance = ray.irradiance * (1.0 / float(max(samples, 1u)));
      if (samples == 0u) found.beam = ray.direction * olx_luminance(ray.irradiance);
    }
  }
  return found;
}

// Returns the light of this dispatch's rays. Lights without an area take one ray.
lit_sum light_place(lit_place p) {
  uint index = call.light, light_sample = call.light_sample;
  lit_sum sum = lit_sum(vec3(0.0), vec3(0.0));
  for (uint k = 0u; k < call.rays; k++) {
    olx_gpu_light light = read_light(index);
    uint samples = olx_light_varies(light) ? relight.light_samples : 0u;
    lit_sum found = light_along(p, light, index, light_sample, samples);
    sum.irradiance += found.irradiance;
    sum.beam += found.beam;
    light_sample++;
    if (light_sample >= samples) light_sample = 0u, index++;
  }
  return sum;
}

bool ends() { return (call.flags & OLX_CALL_ENDS) != 0u; }

// Adds the sum of earlier dispatches, and stores the result for the next one.
vec3 add_up(uint at, vec3 found) {
  if ((call.flags & OLX_CALL_BEGINS) == 0u) found += state_vector(at);
  if (!ends()) set_state(at, found);
  return found;
}

#endif
