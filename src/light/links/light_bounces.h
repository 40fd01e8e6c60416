// Propagates light over links: from the direct light of surfels to their irradiance after any number of bounces.
#ifndef OLX_LIGHT_LIGHT_BOUNCES_H
#define OLX_LIGHT_LIGHT_BOUNCES_H

#include "light/links/links.h"

// The links of all surfels, and the light that their rays find without links.
typedef struct olx_light_links {
  olx_link_batch *batches;
  uint32_t batch_count;
  olx_fixed_light *fixed; // one per surfel
  float *worth;           // total weight of each surfel's rays, in rays of even density
} olx_light_links;

enum { OLX_BOUNCES_KEPT = OLX_CHAIN_MOST + 1 };

// The light between two bounces: everything that later bounces need.
typedef struct olx_bounce_state {
  uint32_t done, surfel_count;
  olx_vec3 *light; // per surfel, light of the last OLX_BOUNCES_KEPT bounces, that of bounce n at index n mod
                   // OLX_BOUNCES_KEPT
  olx_vec3 *irradiance, *passed_on;
} olx_bounce_state;

// Stores the light between bounces, so that an interrupted solution can continue.
typedef struct olx_bounce_keeper {
  void *user;
  // Fills the arrays and `done` of a state, or leaves the state unchanged. Called before the first bounce.
  void (*load)(void *user, olx_bounce_state *state);
  olx_result (*save)(void *user, const olx_bounce_state *state); // called after each bounce except the last
} olx_bounce_keeper;

// Computes the indirect irradiance of surfels in W/m^2, for `direct` irradiance from emitters and the sky, which is not
// included. Stops before `bounces` when surfels lack less than 2^-10 of their light, on average. `passed_on` receives
// the light that surfaces reflect to others: direct light and all bounces but the last. *done receives the number of
// bounces. `keeper` may be NULL.
olx_result olx_bounces_solve(const olx_light_links *links, uint32_t surfel_count, uint32_t threads,
                             const olx_surfel_direct *direct, uint32_t bounces, const olx_bounce_keeper *keeper,
                             olx_vec3 *irradiance, olx_vec3 *passed_on, uint32_t *done);

// Computes the variance of each surfel's mean over its rays, in luminance squared, for surfaces that carry `direct` +
// `irradiance`.
olx_result olx_bounces_variance(const olx_light_links *links, uint32_t surfel_count, uint32_t threads,
                                const olx_surfel_direct *direct, const olx_vec3 *irradiance, float *variance);

#endif
