// What a ray that met an emitter contributes, and how far light came.
#ifndef OLX_SHADE_EMISSION_H
#define OLX_SHADE_EMISSION_H

#include "core/vec.h"

#include <octalux/sample.h>

// Whether light straight from an emitter belongs to what a ray from `origin` found. A probe that saw an emitter's front says
// nothing about its back, which rays meet when they come from behind.
static inline bool olx_emission_counts(const olx_sample_settings *settings, const olx_trace_hit *hit, olx_vec3 origin) {
  if (!settings->emitters) return false;
  return hit->status == OLX_TRACE_MISS || olx_dot(olx_sub(hit->position, origin), hit->normal) < 0.0f;
}

// 1 / distance to what a ray met, 0 for the sky. Nearer than a texel is wide, distances say nothing.
static inline float olx_nearness(const olx_trace_hit *hit) {
  const float metres = olx_max(hit->distance_metres, hit->footprint_metres);
  return metres > 0.0f && metres < INFINITY ? 1.0f / metres : 0.0f;
}

#endif
