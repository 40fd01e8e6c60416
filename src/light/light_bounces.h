// Light going over links: from the direct light of surfels to their irradiance after any number of bounces.
#ifndef OLX_LIGHT_LIGHT_BOUNCES_H
#define OLX_LIGHT_LIGHT_BOUNCES_H

#include "light/links.h"

// All that is known of the rays of surfels.
typedef struct olx_light_links {
  olx_link_batch *batches;
  uint32_t batch_count;
  olx_fixed_light *fixed; // a surfel
  float *worth;           // a surfel: of its rays, in rays of even density
} olx_light_links;

enum { OLX_BOUNCES_KEPT = OLX_CHAIN_MOST + 1 };

// Light between two bounces, all that the next ones need.
typedef struct olx_bounce_state {
  uint32_t done, surfel_count;
  olx_vec3 *light; // of the last OLX_BOUNCES_KEPT bounces, that of bounce n in place n mod OLX_BOUNCES_KEPT; a surfel
  olx_vec3 *irradiance, *passed_on;
} olx_bounce_state;

// Whoever keeps the light between bounces, so that solving can go on from there.
typedef struct olx_bounce_keeper {
  void *user;
  // Fills the arrays and `done` of a state, or leaves all of it alone. Before the first bounce.
  void (*load)(void *user, olx_bounce_state *state);
  olx_result (*save)(void *user, const olx_bounce_state *state); // after each bounce but the last
} olx_bounce_keeper;

// Irradiance of surfels in W/m^2, without emitters and sky seen directly, for `direct` irradiance from these. Stops
// before `bounces` when a further one would add less than 2^-10 of the light. `passed_on` becomes what surfaces reflect
// for others: direct light and all bounces but the last. *done: how many there were. `keeper` may be NULL.
olx_result olx_bounces_solve(const olx_light_links *links, uint32_t surfel_count, uint32_t threads,
                             const olx_vec3 *direct, uint32_t bounces, const olx_bounce_keeper *keeper,
                             olx_vec3 *irradiance, olx_vec3 *passed_on, uint32_t *done);

// Variance of each surfel's mean over its rays, as luminance squared, when surfaces carry `direct` + `irradiance`.
olx_result olx_bounces_variance(const olx_light_links *links, uint32_t surfel_count, uint32_t threads,
                                const olx_vec3 *direct, const olx_vec3 *irradiance, float *variance);

#endif
