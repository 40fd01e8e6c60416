// Direct light of places, which are points of surfels or texels, by the lights of a relighter.
#ifndef OLX_RELIGHT_RELIT_DIRECT_H
#define OLX_RELIGHT_RELIT_DIRECT_H

#include "relight/relit_lights.h"

#include <octalux/sample.h>

#include <stdatomic.h>

enum { OLX_RELIT_BATCH = 256 }; // places that are lit together

// The lights, and what shadow rays to them are tested with.
typedef struct olx_relit_direct {
  const olx_relit_lights *lights;
  const olx_field *source; // through which rays are traced where the settings have no occlusion
  olx_sample_settings sample;
  atomic_uint_fast64_t shadow_rays; // cast in the current frame
} olx_relit_direct;

typedef struct olx_relit_batch {
  uint32_t count;
  olx_vec3 position[OLX_RELIT_BATCH], normal[OLX_RELIT_BATCH]; // position: moved slightly off the surface
  uint32_t seed[OLX_RELIT_BATCH], sequence[OLX_RELIT_BATCH];
  uint32_t slot[OLX_RELIT_BATCH];       // the surfel or texel to which the place belongs
  olx_vec3 irradiance[OLX_RELIT_BATCH]; // W/m^2, directly from lights
  olx_vec3 beam[OLX_RELIT_BATCH];       // its luminance by lights without area, along the way to them
  // For surfels: the light of lamps close by is kept apart, because links do not carry it. What the surfaces near lamps
  // reflect arrives from their points instead.
  bool apart;
  olx_vec3 close[OLX_RELIT_BATCH]; // W/m^2, directly from lamps close by
  olx_vec3 near[OLX_RELIT_BATCH];  // W/m^2, from surfaces near lamps
} olx_relit_batch;

// Computes the direct light of a batch: one sample of it where it varies. Called from several threads at once.
void olx_relit_light(olx_relit_direct *direct, olx_relit_batch *batch);

#endif
