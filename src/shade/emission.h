// Computes what a ray that met an emitter contributes, and how far light came. Its twin is shaders/lib/emission.glsl.
#ifndef OLX_SHADE_EMISSION_H
#define OLX_SHADE_EMISSION_H

#include "core/vec.h"

#include <octalux/sample.h>

// Returns whether a ray from `origin` hit the emitting side of an emitter. A probe that saw an emitter's front knows
// nothing about its back, which rays from behind hit.
static inline bool olx_emission_faces(const olx_trace_hit *hit, olx_vec3 origin) {
  return hit->status == OLX_TRACE_MISS || olx_dot(olx_sub(hit->position, origin), hit->normal) < 0.0f;
}

// Returns the light that a ray from `origin` found: what the surface reflects, and what it emits where that counts.
static inline olx_vec3 olx_light_found(const olx_sample_settings *settings, const olx_trace_hit *hit, olx_vec3 origin) {
  if (!settings->emitters || !olx_emission_faces(hit, origin)) return hit->radiance;
  return olx_add(hit->radiance, hit->emission);
}

// Returns 1 / distance to the ray's hit, 0 for the sky. Distances below a texel's width are inaccurate, so the width is
// the least.
static inline float olx_nearness(const olx_trace_hit *hit) {
  const float metres = olx_max(hit->distance_metres, hit->footprint_metres);
  return metres > 0.0f && metres < INFINITY ? 1.0f / metres : 0.0f;
}

#endif
