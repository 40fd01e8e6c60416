// Twin of src/shade/emission.h: what a ray that met an emitter contributes, and how far light came.
//
// SPDX-License-Identifier: MIT
#ifndef OLX_EMISSION_GLSL
#define OLX_EMISSION_GLSL

#include "trace.glsl"

// Whether a ray from `origin` found the shining side of what emits. A probe that saw an emitter's front says nothing
// about its back, which rays meet when they come from behind.
bool olx_emission_faces(olx_trace_hit hit, vec3 origin) {
  return hit.status == OLX_TRACE_MISS || olx_dot(hit.position - origin, hit.normal) < 0.0;
}

// Light that a ray from `origin` found: what the surface reflects, and what it emits where that counts.
vec3 olx_light_found(olx_sample_settings settings, olx_trace_hit hit, vec3 origin) {
  return hit.radiance + (settings.emitters && olx_emission_faces(hit, origin) ? hit.emission : vec3(0.0));
}

// 1 / distance to what a ray met, 0 for the sky. Nearer than a texel is wide, distances say nothing.
float olx_nearness(olx_trace_hit hit) {
  float metres = max(hit.distance_metres, hit.footprint_metres);
  return metres > 0.0 && metres < OLX_INFINITY ? 1.0 / metres : 0.0;
}

#endif
