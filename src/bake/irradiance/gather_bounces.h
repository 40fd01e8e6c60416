// Bounces of light between irradiance probes, an alternative to the solution for the whole scene: from the irradiance
// of the previous bounce (McGuire et al. 2017, section 5.2), or by rays to surfaces whose light probes have stored.
#ifndef OLX_BAKE_GATHER_BOUNCES_H
#define OLX_BAKE_GATHER_BOUNCES_H

#include "bake/irradiance/gather_state.h"

// Adds the direct light of a tile of samples of gather->probe to its cells; `scratch` holds their rays and hits.
void olx_gather_light_tile(const olx_gather *gather, olx_shade_scratch *scratch, uint32_t tile);

// Finds where the rays of traced bounces end, once all probes have cast their own rays.
olx_result olx_gather_link(olx_gather *gather);
// Computes the light of bounce `bounce`, at least 1, from the previous bounce.
olx_result olx_gather_bounce(olx_gather *gather, uint32_t bounce);

// Returns whether bounce `bounce`, at least 1, raises the irradiance of the previous bounce by more than a share of
// 2^-10.
bool olx_gather_brought_light(const olx_gather *gather, uint32_t bounce);
// Counts the work of this many skipped bounces as done.
void olx_gather_skip(olx_gather *gather, uint32_t bounces);

#endif
