// Twin of src/shade/emission.h: computes what a ray that met an emitter contributes, and how far light came.
//
// SPDX-License-Identifier: MIT
#ifndef OLX_EMISSION_GLSL
#define OLX_EMISSION_GLSL

#include "trace.glsl"

// Returns whether a ray from `origin` hit the emitting side of an emitter. A probe that saw an emitter's front knows
// nothing about its back, which rays from behind hit.
bool olx_emission_faces(olx_trace_hit hit, vec3 origin) {
  return hit.status == OLX_TRACE_MISS || olx_dot(hit.position - origin, hit.normal) < 0.0;
}

// Returns the light that a ray from `origin` found: what the surface reflects, and what it emits where that counts.
vec3 olx_light_found(olx_sample_settings settings, olx_trace_hit hit, vec3 origin) {
  return hit.radiance + (settings.emitters && olx_emission_faces(hit, origin) ? hit.emission : vec3(0.0));
}

// Returns 1 / distance to the ray's hit, 0 for the sky. Distances below a texel's width are inaccurate, so the width is
// the least.
float olx_nearness(olx_trace_hit hit) {
  float metres = max(hit.distance_metres, hit.footprint_metres);
  return metres > 0.0 && metres < OLX_INFINITY ? 1.0 / metres : 0.0;
}

#endif
