// What gathering keeps from step to step: the probes, what each sees, and the light of bounces.
#ifndef OLX_BAKE_GATHER_STATE_H
#define OLX_BAKE_GATHER_STATE_H

#include "bake/bake_context.h"
#include "bake/projection.h"
#include "bake/quadrature.h"
#include "bake/shade_batch.h"
#include "bake/surface_fit.h"
#include "bake/traced_bounce.h"
#include "light/scene_light.h"

typedef struct olx_gather {
  olx_bake_context *context;
  olx_shade_context *shade;
  const olx_scene_light *light; // solved for the whole scene, or NULL: bounces between the probes (gather_bounces.h)
  olx_quadrature quadrature;
  olx_ray_hit *hits;         // of each probe's gather points, four a cell
  olx_vec3 *total;           // radiance of each probe's cells
  olx_vec3 *direct;          // direct light in it; NULL with `light`
  olx_vec2 *distances;       // of one probe's distance cells: mean and mean square
  olx_vec2 *moments;         // maps with border
  olx_bounce_maps maps;      // with `light`, of one bounce alone, which is all light
  uint32_t probe;            // that is worked on, in loops over the parts of one
  uint32_t bounce;           // that is gathered
  olx_vec3 *irradiance;      // one probe's final map
  olx_surface_fit *fit;      // NULL until the first olx_gather_fit
  olx_projection projection; // where the file's irradiance is spherical harmonics
  olx_vec3 *harmonics;       // and the coefficients of all probes, once they are made
  bool traces;               // bounces are gathered by rays: the caller's to set
  olx_traced_bounce traced;
} olx_gather;

static inline const olx_probe_list *olx_gather_probes(const olx_gather *gather) {
  return &gather->context->probes.irradiance;
}

#endif
