// Twin of src/shade/emission.h: what a ray that met an emitter contributes, and how far light came.
#ifndef OLX_EMISSION_GLSL
#define OLX_EMISSION_GLSL

#include "trace.glsl"

// Whether light straight from an emitter belongs to what a ray from `origin` found. A probe that saw an emitter's front
// says nothing about its back, which rays meet when they come from behind.
bool olx_emission_counts(olx_sample_settings settings, olx_trace_hit hit, vec3 origin) {
  if (!settings.emitters) return false;
  return hit.status == OLX_TRACE_MISS || olx_dot(hit.position - origin, hit.normal) < 0.0;
}

// 1 / distance to what a ray met, 0 for the sky. Nearer than a texel is wide, distances say nothing.
float olx_nearness(olx_trace_hit hit) {
  float metres = max(hit.distance_metres, hit.footprint_metres);
  return metres > 0.0 && metres < OLX_INFINITY ? 1.0 / metres : 0.0;
}

#endif
