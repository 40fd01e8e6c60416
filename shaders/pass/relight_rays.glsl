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
  return olx_gpu_light(vec4(state_vector(at), uintBitsToFloat(state[at + 3u])), vec4(state_vector(at + 4u), 0.0),
                       vec4(state_vector(at + 8u), 0.0), vec4(state_vector(at + 12u), 0.0), state[at + 16u],
                       state[at + 17u], uintBitsToFloat(state[at + 18u]), uintBitsToFloat(state[at + 19u]));
}

// The direct light at a place: irradiance, and its luminance by lights without area, along the way to them; and, kept
// apart for surfels, light of lamps close by and of surfaces near lamps.
struct lit_sum {
  vec3 irradiance, beam, close, near;
};

olx_gpu_lamp_point read_lamp_point(uint index) {
  uint at = relight.lamp_points + OLX_LAMP_POINT_WORDS * index;
  return olx_gpu_lamp_point(vec4(state_vector(at), uintBitsToFloat(state[at + 3u])),
                            vec4(state_vector(at + 4u), uintBitsToFloat(state[at + 7u])),
                            vec4(state_vector(at + 8u), uintBitsToFloat(state[at + 11u])));
}

// Returns the point of a surface near a lamp that a number in [0, 1) draws.
olx_gpu_lamp_point draw_lamp_point(float random) {
  uint low = 0u, high = relight.lamp_point_count;
  while (high - low > 1u) {
    uint middle = low + (high - low) / 2u;
    if (uintBitsToFloat(state[relight.lamp_points + OLX_LAMP_POINT_WORDS * middle + 3u]) <= random) low = middle;
    else high = middle;
  }
  return read_lamp_point(low);
}

// Draws a ray of a place to a light, or to a surface near a lamp; false when no light comes from there.
bool draw_ray(lit_place p, uint index, uint light_sample, uint samples, olx_gpu_light light, out olx_light_ray ray) {
  if (index >= relight.light_count) {
    float random =
        olx_stratified2(p.sequence * OLX_LAMP_SAMPLES + light_sample, olx_hash2(p.seed, OLX_SALT_LAMP)).x;
    return olx_aim_near(draw_lamp_point(random), p.position, p.normal, ray);
  }
  vec2 random = vec2(0.0);
  uint seed = olx_hash3(p.seed, index, OLX_SALT_LIGHT);
  if (samples > 0u) random = olx_stratified2(p.sequence * samples + light_sample, seed);
  return olx_aim(light, p.position, p.normal, random, ray);
}

// Adds the light of one ray. An unresolved ray counts as shadowed.
void add_light(lit_place p, olx_gpu_light light, uint index, uint light_sample, uint samples, inout lit_sum sum) {
  olx_light_ray ray;
  if (!draw_ray(p, index, light_sample, samples, light, ray)) return;
  olx_trace_hit hit = olx_trace(olx_sample_settings_default(), p.position, ray.direction, ray.length_metres);
  if (hit.status != OLX_TRACE_MISS) return;
  vec3 found = ray.irradiance * (1.0 / float(max(samples, 1u)));
  if (index >= relight.light_count) {
    sum.near += found;
  } else if (ray.length_metres < light.emission.w * (1.0 - OLX_END_SHARE)) {
    sum.close += found;
  } else {
    sum.irradiance += found;
    if (samples == 0u) sum.beam += ray.direction * olx_luminance(found);
  }
}

// Returns the light of this dispatch's rays. Lights without an area take one ray.
lit_sum light_place(lit_place p) {
  uint index = call.light, light_sample = call.light_sample;
  lit_sum sum = lit_sum(vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0));
  for (uint k = 0u; k < call.rays; k++) {
    bool lamps = index >= relight.light_count;
    olx_gpu_light light = read_light(lamps ? 0u : index);
    uint samples = lamps ? OLX_LAMP_SAMPLES : olx_light_varies(light) ? relight.light_samples : 0u;
    add_light(p, light, index, light_sample, samples, sum);
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
