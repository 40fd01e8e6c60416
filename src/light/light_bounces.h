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

// Irradiance of surfels in W/m^2, without emitters and sky seen directly, for `direct` irradiance from these. Stops before
// `bounces` when a further one would add less than 2^-10 of the light. `passed_on` becomes what surfaces reflect for others:
// direct light and all bounces but the last. *done: how many there were.
olx_result olx_bounces_solve(const olx_light_links *links, uint32_t surfel_count, uint32_t threads,
                             const olx_vec3 *direct, uint32_t bounces, olx_vec3 *irradiance, olx_vec3 *passed_on,
                             uint32_t *done);

// Variance of each surfel's mean over its rays, as luminance squared, when surfaces carry `direct` + `irradiance`.
olx_result olx_bounces_variance(const olx_light_links *links, uint32_t surfel_count, uint32_t threads,
                                const olx_vec3 *direct, const olx_vec3 *irradiance, float *variance);

#endif
