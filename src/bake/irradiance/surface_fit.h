// Fitting irradiance maps to the surfaces they will light.
//
// Irradiance that is interpolated between probes misses how light changes between them: a wall near a corner gets less
// light than the probes in front of it. The baker has the surfaces, so it measures irradiance at points on them and
// adds to each probe's map the correction, smooth in direction, with which interpolation by the runtime's own weights
// comes closest in the least-squares sense. Reading costs the same; in directions that no surface faces the correction
// fades out.
#ifndef OLX_BAKE_SURFACE_FIT_H
#define OLX_BAKE_SURFACE_FIT_H

#include "bake/bake_context.h"
#include "bake/capture/shade_batch.h"
#include "bake/irradiance/corrections.h"
#include "light/scene_light.h"

typedef struct olx_surface_fit olx_surface_fit;

// Everything the fit needs of the gather: `hits` are `hit_count` surface points that each probe sees. Irradiance at the
// points comes from `light`, or is measured by rays where that is NULL.
typedef struct olx_surface_fit_input {
  olx_bake_context *context;
  olx_shade_context *shade;
  const olx_ray_hit *hits;
  uint32_t hit_count;
  const olx_scene_light *light;
} olx_surface_fit_input;

// Draws points on surfaces and casts the rays that will measure irradiance there. `source` gives the weights of
// interpolation; its moments must be filled.
olx_result olx_surface_fit_create(const olx_surface_fit_input *input, const olx_irradiance_source *source,
                                  olx_surface_fit **fit);
void olx_surface_fit_free(olx_surface_fit *fit);

// Units of progress of one creation, in rays; `solved` says whether irradiance comes from a solution.
uint64_t olx_surface_fit_units(uint32_t probe_count, bool solved);

// Returns the memory that a fit holds.
uint64_t olx_surface_fit_bytes(uint32_t probe_count, bool solved);

// Solves for the corrections of `source`, float irradiance maps of bounce `bounce` (0: direct light alone), measured
// with the light of earlier bounces. With `light` the measurement is of all light, whatever the bounce.
olx_result olx_surface_fit_solve(olx_surface_fit *fit, const olx_irradiance_source *source, uint32_t bounce);

// Points of each probe, and rays from each point, which a fit to a solution does not cast.
enum { OLX_FIT_POINTS_PER_PROBE = 512, OLX_FIT_RAYS = 64 };

// What the last olx_surface_fit_solve measured at a point, and the probes from which the point is interpolated.
typedef struct olx_surface_measurement {
  olx_vec3 normal, irradiance;
  const olx_irradiance_weights *weights;
} olx_surface_measurement;
// Returns the measurement at point `index` over all probes, or false when there is no such point.
bool olx_surface_fit_measurement(const olx_surface_fit *fit, uint32_t index, olx_surface_measurement *measurement);

// Returns the correction that was solved last, for a direction of a probe's map.
olx_vec3 olx_surface_fit_correction(const olx_surface_fit *fit, uint32_t probe, olx_vec2 uv);

#endif
