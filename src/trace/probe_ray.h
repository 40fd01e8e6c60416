// A ray as a probe sees it, and the probe's answer.
#ifndef OLX_TRACE_PROBE_RAY_H
#define OLX_TRACE_PROBE_RAY_H

#include "field/maps.h"

#include <octalux/sample.h>

// A ray relative to a probe: all distances in metres along the unit direction.
typedef struct olx_probe_ray {
  olx_vec3 origin; // from the probe's centre
  olx_vec3 direction;
  float t_min, t_max;
} olx_probe_ray;

typedef struct olx_probe_answer {
  olx_trace_status status;
  float t;        // HIT: of the hit; UNKNOWN: where the ray went out of sight; MISS: t_max
  size_t texel;   // HIT: that was hit; UNKNOWN: that hides the ray; MISS: in the ray's direction
  float gap;      // UNKNOWN: how far behind the hiding texel's surface the ray was, in footprints
  uint32_t steps; // distances read, of texels and of blocks
} olx_probe_answer;

// A ray for a probe to answer.
typedef struct olx_probe_job {
  uint32_t probe;
  olx_probe_ray ray;
} olx_probe_job;

#endif
