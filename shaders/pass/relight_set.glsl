// The buffers of a relighter and vectors in them, shared by its passes, whose order is in docs/relighting.md, "Frames
// on the device".
#ifndef RELIGHT_SET_GLSL
#define RELIGHT_SET_GLSL

#define OLX_FIELD_SET 1
#include "../lib/relight.glsl"

layout(local_size_x = OLX_RELIGHT_GROUP) in;
layout(push_constant, std430) uniform call_block { olx_gpu_relight_call call; };
layout(set = 0, binding = OLX_BINDING_STATE, std430) buffer state_block {
  olx_gpu_relight relight;
  uint state[];
};
layout(set = 0, binding = OLX_BINDING_STRUCTURE, std430) readonly buffer structure_block { uint structure[]; };

// Returns the number of the workgroup. Workgroups lie in two dimensions, because devices limit their number along one.
uint group_index() { return gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x; }
uint thread_index() { return group_index() * OLX_RELIGHT_GROUP + gl_LocalInvocationIndex; }

vec3 state_vector(uint at) { return uintBitsToFloat(uvec3(state[at], state[at + 1u], state[at + 2u])); }

void set_state(uint at, vec3 v) {
  state[at] = floatBitsToUint(v.x);
  state[at + 1u] = floatBitsToUint(v.y);
  state[at + 2u] = floatBitsToUint(v.z);
}

// Returns the surfel of a thread; surfels follow each other cyclically from call.first on.
uint surfel_of(uint thread) { return (call.first + thread) % relight.surfels; }

// ---- Surfels of the structure

vec3 surfel_point(uint surfel, uint point) {
  uint at = OLX_RELIGHT_SURFEL_WORDS * surfel + 3u * point;
  return uintBitsToFloat(uvec3(structure[at], structure[at + 1u], structure[at + 2u]));
}

vec3 surfel_normal(uint surfel) {
  return olx_normal_unpack(structure[OLX_RELIGHT_SURFEL_WORDS * surfel + 3u * OLX_RELIGHT_POINTS] & 0xFFFFu);
}

// Returns the reflectance of a surfel's surface: diffuse, specular, F0 and alpha.
vec4 surfel_reflectance(uint surfel) {
  uint bytes = structure[OLX_RELIGHT_SURFEL_WORDS * surfel + 3u * OLX_RELIGHT_POINTS + 2u];
  return vec4(bytes & 0xFFu, bytes >> 8 & 0xFFu, bytes >> 16 & 0xFFu, bytes >> 24) * (1.0 / 255.0);
}

#endif
