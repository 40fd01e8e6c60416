// What gathering keeps from step to step: the probes, what each sees, and the light of bounces.
#ifndef OLX_BAKE_GATHER_STATE_H
#define OLX_BAKE_GATHER_STATE_H

#include "bake/projection.h"
#include "bake/quadrature.h"
#include "bake/shade_batch.h"
#include "bake/surface_fit.h"
#include "bake/traced_bounce.h"
#include "core/parallel.h"
#include "light/scene_light.h"

#include <octalux/bake.h>

typedef struct olx_gather {
  olx_shade_context *shade;
  const olx_vec3 *positions;
  const uint8_t *flags; // OLX_PROBE_*
  uint32_t probe_count, light_samples, threads;
  float distance_scale;
  olx_task *task;
  const olx_scene_light *light; // solved for the whole scene, or NULL: bounces between the probes (gather_bounces.h)
  olx_quadrature quadrature;
  uint32_t map_size;   // of the maps of the bounces
  olx_ray_hit *hits;   // of each probe's gather points, four a cell
  olx_vec3 *total;     // radiance of each probe's cells
  olx_vec3 *direct;    // direct light in it; NULL with `light`
  olx_vec2 *distances; // of one probe's distance cells: mean and mean square
  olx_vec2 *moments;   // maps with border
  // Irradiance with border: of bounce k at k mod (OLX_KEPT_BOUNCES + 1); with `light`, one map alone.
  olx_vec3 *maps[OLX_KEPT_BOUNCES + 1];
  uint32_t probe;            // that is worked on, in loops over the parts of one
  uint32_t bounce;           // that is gathered
  olx_vec3 *irradiance;      // one probe's final map
  olx_surface_fit *fit;      // NULL until the first olx_gather_fit
  olx_irradiance_form form;  // of the file's irradiance: the caller's to set
  olx_projection projection; // where that is spherical harmonics
  olx_vec3 *harmonics;       // and the coefficients of all probes, once they are made
  bool traces;               // bounces are gathered by rays: the caller's to set
  olx_traced_bounce traced;
} olx_gather;

#endif
