// What nodes send on: the sums of their members, level by level. Where one workgroup has several small levels, each
// waits for the one before.
#version 460
#extension GL_GOOGLE_include_directive : require
#define RELIGHT_STATE coherent
#include "relight_set.glsl"

void sum_node(uint node) {
  uint end = structure[relight.member_starts + node + 1u];
  vec3 sum = vec3(0.0);
  for (uint i = structure[relight.member_starts + node]; i < end; i++) {
    uint member = relight.members + 2u * i;
    sum += state_vector(relight.values + 3u * structure[member]) * uintBitsToFloat(structure[member + 1u]);
  }
  set_state(relight.values + 3u * (relight.surfels + node), sum);
}

void main() {
  uint threads = gl_NumWorkGroups.x * gl_NumWorkGroups.y * OLX_RELIGHT_GROUP;
  for (uint level = call.first; level < call.first + call.count; level++) {
    uint end = structure[relight.level_starts + level + 1u];
    for (uint i = structure[relight.level_starts + level] + thread_index(); i < end; i += threads) {
      sum_node(structure[relight.level_nodes + i]);
    }
    memoryBarrierBuffer();
    barrier();
  }
}
