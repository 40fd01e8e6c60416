// Bounces of light between irradiance probes, instead of the solution for the whole scene: from the irradiance of the
// bounce before (McGuire et al. 2017, section 5.2), or by rays that find what probes stored of it.
#ifndef OLX_BAKE_GATHER_BOUNCES_H
#define OLX_BAKE_GATHER_BOUNCES_H

#include "bake/gather_state.h"

// Adds the direct light of a tile of samples of gather->probe to its cells; `scratch` holds their rays and hits.
void olx_gather_light_tile(const olx_gather *gather, olx_shade_scratch *scratch, uint32_t tile);

// Once all probes have looked around, where bounces are traced: finds where rays between surfaces end.
olx_result olx_gather_link(olx_gather *gather);
// Light of bounce `bounce`, at least 1, from the one before.
olx_result olx_gather_bounce(olx_gather *gather, uint32_t bounce);

// Whether the irradiance of bounce `bounce`, at least 1, is more than that of the one before by 2^-10 of it.
bool olx_gather_brought_light(const olx_gather *gather, uint32_t bounce);
// Counts the work of so many bounces as done that are not made.
void olx_gather_skip(olx_gather *gather, uint32_t bounces);

#endif
