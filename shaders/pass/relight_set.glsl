// What the passes of a relighter share: its buffers, jobs, and the places that they light. docs/relighting.md, "On
// Vulkan", tells their order.
#ifndef RELIGHT_SET_GLSL
#define RELIGHT_SET_GLSL

#define OLX_FIELD_SET 1
#include "../lib/relight.glsl"

layout(local_size_x = OLX_RELIGHT_GROUP) in;
layout(push_constant) uniform call_block { uint call_index; };
layout(set = 0, binding = OLX_BINDING_STATE, std430) buffer state_block {
  olx_gpu_relight relight;
  uint state[];
};
layout(set = 0, binding = OLX_BINDING_PLACES, std430) buffer places_block { uint places[]; };
layout(set = 0, binding = OLX_BINDING_SURFACE_RADIANCE, std430) buffer radiance_block { float radiance[]; };
layout(set = 0, binding = OLX_BINDING_FIT, std430) readonly buffer fit_block { uint fit[]; };
layout(set = 0, binding = OLX_BINDING_PACKED, std430) writeonly buffer packed_block { uint packed_maps[]; };

uint call_word(uint i) { return state[relight.calls + OLX_CALL_WORDS * call_index + i]; }

// What this dispatch does.
olx_gpu_relight_call call = olx_gpu_relight_call(call_word(0u), call_word(1u), call_word(2u), call_word(3u));

// A probe whose surfaces are lit, or one tile of a light field map.
struct relight_job {
  uint probe;
  uint flags; // OLX_JOB_*
  uint rounds, tile;
  vec3 position;
  float history;
};

vec3 state_vector(uint at) {
  return vec3(uintBitsToFloat(state[at]), uintBitsToFloat(state[at + 1u]), uintBitsToFloat(state[at + 2u]));
}

void set_state(uint at, vec3 v) {
  state[at] = floatBitsToUint(v.x);
  state[at + 1u] = floatBitsToUint(v.y);
  state[at + 2u] = floatBitsToUint(v.z);
}

vec3 places_vector(uint at) {
  return vec3(uintBitsToFloat(places[at]), uintBitsToFloat(places[at + 1u]), uintBitsToFloat(places[at + 2u]));
}

void set_places(uint at, vec3 v) {
  places[at] = floatBitsToUint(v.x);
  places[at + 1u] = floatBitsToUint(v.y);
  places[at + 2u] = floatBitsToUint(v.z);
}

vec3 radiance_vector(uint at) { return vec3(radiance[at], radiance[at + 1u], radiance[at + 2u]); }

relight_job read_job(uint first, uint index) {
  uint at = first + OLX_JOB_WORDS * index;
  return relight_job(state[at], state[at + 1u], state[at + 2u], state[at + 3u], state_vector(at + 4u),
                     uintBitsToFloat(state[at + 7u]));
}

uint surfaces_a_probe() { return relight.size * relight.size; }

olx_surface_view view_of(vec3 probe, vec3 direction, uint normal_bits, uint distance_bits, uint albedo) {
  olx_surface_view v = olx_surface_view(vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), OLX_INFINITY);
  if (!olx_known_distance(distance_bits)) return v;
  v.distance_metres = olx_half_unpack(distance_bits) * relight.distance_scale;
  v.normal = olx_normal_unpack(normal_bits);
  v.view = -direction;
  v.albedo = olx_relit_albedo(albedo);
  v.place = probe + direction * v.distance_metres + v.normal * (OLX_OFF_SURFACE * v.distance_metres);
  return v;
}

// Surface i of an irradiance probe.
olx_surface_view view_surface(relight_job job, uint i) {
  uint at = 2u * (surfaces_a_probe() * job.probe + i), bits = places[at + 1u];
  vec3 direction = olx_surface_direction(uvec2(i % relight.size, i / relight.size), relight.size);
  return view_of(job.position, direction, bits & 0xFFFFu, bits >> 16, places[at]);
}

#endif
