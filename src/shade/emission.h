// What a ray that met an emitter contributes, and how far light came.
#ifndef OLX_SHADE_EMISSION_H
#define OLX_SHADE_EMISSION_H

#include "core/vec.h"

#include <octalux/sample.h>

// Whether a ray from `origin` found the shining side of what emits. A probe that saw an emitter's front says nothing
// about its back, which rays meet when they come from behind.
static inline bool olx_emission_faces(const olx_trace_hit *hit, olx_vec3 origin) {
  return hit->status == OLX_TRACE_MISS || olx_dot(olx_sub(hit->position, origin), hit->normal) < 0.0f;
}

// Light that a ray from `origin` found: what the surface reflects, and what it emits where that counts.
static inline olx_vec3 olx_light_found(const olx_sample_settings *settings, const olx_trace_hit *hit, olx_vec3 origin) {
  if (!settings->emitters || !olx_emission_faces(hit, origin)) return hit->radiance;
  return olx_add(hit->radiance, hit->emission);
}

// 1 / distance to what a ray met, 0 for the sky. Nearer than a texel is wide, distances say nothing.
static inline float olx_nearness(const olx_trace_hit *hit) {
  const float metres = olx_max(hit->distance_metres, hit->footprint_metres);
  return metres > 0.0f && metres < INFINITY ? 1.0f / metres : 0.0f;
}

#endif
