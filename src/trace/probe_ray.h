// A ray relative to a probe, and the probe's answer to it.
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
  float t;        // HIT: of the hit; UNKNOWN: where the ray became hidden; MISS: t_max
  size_t texel;   // HIT: the one hit; UNKNOWN: the one that hides the ray; MISS: the one in the ray's direction
  float gap;      // UNKNOWN: how far the ray was behind the hiding texel's surface, in footprints
  uint32_t steps; // number of distances read, of texels and of blocks
} olx_probe_answer;

// A ray to trace through one probe's map.
typedef struct olx_probe_job {
  uint32_t probe;
  olx_probe_ray ray;
} olx_probe_job;

#endif
