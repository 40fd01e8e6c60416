// Irradiance probes: what each sees, gathered into cells, and the maps that are made of it.
#ifndef OLX_BAKE_GATHER_H
#define OLX_BAKE_GATHER_H

#include "bake/projection.h"
#include "bake/quadrature.h"
#include "bake/shade_batch.h"
#include "bake/surface_fit.h"
#include "bake/traced_bounce.h"
#include "core/parallel.h"
#include "field/field_writer.h"
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
  olx_vec3 *maps[OLX_KEPT_BOUNCES + 1]; // irradiance with border, of bounce k at k mod (OLX_KEPT_BOUNCES + 1); with `light` one
  uint32_t probe;                       // that is worked on, in loops over the parts of one
  uint32_t bounce;
  olx_vec3 *irradiance;      // one probe's final map
  olx_surface_fit *fit;      // NULL until the first olx_gather_fit
  olx_irradiance_form form;  // of the file's irradiance: the caller's to set
  olx_projection projection; // where that is spherical harmonics
  olx_vec3 *harmonics;       // and the coefficients of all probes, once they are made
  bool traces;               // bounces are gathered by rays: the caller's to set
  olx_traced_bounce traced;
} olx_gather;

// Everything but the tables and maps is the caller's to fill. `bounces` is the number of the last bounce.
olx_result olx_gather_create(olx_gather *gather, const olx_grid *grid, uint32_t irradiance_size, uint32_t bounces);
void olx_gather_free(olx_gather *gather);

// The memory that gathering takes at most at once, from the solution (`solved`) or by bounces, with a fit of irradiance (`fits`)
// or without. The gather need not be created.
uint64_t olx_gather_bytes(const olx_gather *gather, uint32_t irradiance_size, uint32_t bounces, bool solved, bool fits);

// Units of progress that the whole of gathering takes, in rays.
uint64_t olx_gather_units(const olx_gather *gather, uint32_t bounces, bool solved);

// What all probes see, and distances; without `light` also direct light.
olx_result olx_gather_look(olx_gather *gather);
// Light of all that probes see, from the solution.
olx_result olx_gather_solved(olx_gather *gather);
// The irradiance of bounce `bounce`, for the next to gather from and for shading; with `light`, of all light, bounce 0.
olx_result olx_gather_irradiance(olx_gather *gather, uint32_t bounce);
// Fits that irradiance, made before, to the surfaces.
olx_result olx_gather_fit(olx_gather *gather, uint32_t bounce);
// Before the final maps are packed, when all light is gathered.
olx_result olx_gather_finish(olx_gather *gather);
// The final maps of a probe, corrected by the last fit, as olx_field_writer_irradiance takes them: irradiance, then moments in the
// second half of `record`.
olx_result olx_gather_pack(olx_gather *gather, uint32_t probe, uint32_t *record);
// Words of a record. Only the quadrature must be known.
size_t olx_gather_record_words(const olx_gather *gather);

// Fails when some thread had no memory to work in.
olx_result olx_gather_check_memory(const olx_gather *gather);

#endif
