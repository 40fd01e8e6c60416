// The state of gathering: the probes, what each sees, and the light of bounces.
#ifndef OLX_BAKE_GATHER_STATE_H
#define OLX_BAKE_GATHER_STATE_H

#include "bake/bake_context.h"
#include "bake/capture/shade_batch.h"
#include "bake/irradiance/projection.h"
#include "bake/irradiance/quadrature.h"
#include "bake/irradiance/surface_fit.h"
#include "bake/irradiance/traced_bounce.h"
#include "light/scene_light.h"

typedef struct olx_gather {
  olx_bake_context *context;
  olx_shade_context *shade;
  const olx_scene_light *light; // solved for the whole scene, or NULL: bounces between the probes (gather_bounces.h)
  olx_quadrature quadrature;
  olx_ray_hit *hits;         // hits of each probe's gather points, four per cell
  olx_vec3 *total;           // radiance of each probe's cells
  olx_vec3 *direct;          // direct light in `total`; NULL with `light`
  olx_vec2 *distances;       // mean and mean square of one probe's distance cells
  olx_vec2 *moments;         // maps with border
  olx_bounce_maps maps;      // with `light`, of a single bounce that is all light
  uint32_t probe;            // probe in work, for loops over the parts of one probe
  uint32_t bounce;           // bounce in work
  olx_vec3 *irradiance;      // one probe's final map
  olx_surface_fit *fit;      // NULL until the first olx_gather_fit
  olx_projection projection; // used where the file stores irradiance as spherical harmonics
  olx_vec3 *harmonics;       // coefficients of all probes, once computed
  bool traces;               // whether bounces are gathered by rays; set by the caller
  olx_traced_bounce traced;
} olx_gather;

static inline const olx_probe_list *olx_gather_probes(const olx_gather *gather) {
  return &gather->context->probes.irradiance;
}

#endif
