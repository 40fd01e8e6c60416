// The light of surfels: direct light, and what links carry from surfel to surfel.
#ifndef OLX_RELIGHT_RELIT_SURFELS_H
#define OLX_RELIGHT_RELIT_SURFELS_H

#include "relight/relit_direct.h"
#include "relight/relit_turns.h"

typedef struct olx_relit_surfels {
  const olx_relight_data *data;
  olx_vec3 *direct, *irradiance; // of each surfel, W/m^2; irradiance is indirect
  olx_vec3 *values;              // `direct` + `irradiance` + `close` at the time when links were last followed
  olx_vec3 *beams;      // of each surfel: its direct light's luminance by lights without area, along the way to them
  olx_vec3 *close;      // of each surfel: direct light of lamps close by, W/m^2, which is not part of `direct`
  olx_vec3 *near;       // of each surfel: light that arrives from surfaces near lamps, W/m^2
  olx_vec3 *highlights; // of each surfel: specular reflections of direct light that arrive, W/m^2
  double *job_changes, *job_sums; // of each job of a frame
} olx_relit_surfels;

// Creates surfels with the light of the bake.
olx_result olx_relit_surfels_create(const olx_relight_data *data, olx_relit_surfels *surfels);
void olx_relit_surfels_free(olx_relit_surfels *surfels);

// Adds a sample of direct light to the surfels whose turn it is.
void olx_relit_light_surfels(olx_relit_surfels *surfels, olx_relit_direct *direct, const olx_relit_surfel_turns *turns);

// Carries light over the links of the surfels whose turn it is, and sums how much of their light changed and how much
// there is.
void olx_relit_bounce(olx_relit_surfels *surfels, uint32_t threads, const olx_relit_link_turns *turns, double *change,
                      double *sum);

// Returns the specular reflections of direct light that arrive at a surfel, W/m^2 (relit_highlights.c).
olx_vec3 olx_relit_highlights(const olx_relit_surfels *surfels, uint32_t surfel);

#endif
