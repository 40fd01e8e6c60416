// Final gathering: where links for enough rays do not fit into memory, surfels cast rays that leave none once the light
// is solved. Each brings what surfels pass on, and sums alone are kept, so that time instead of memory bounds noise.
#ifndef OLX_LIGHT_FINAL_GATHER_H
#define OLX_LIGHT_FINAL_GATHER_H

#include "light/solution/light_ranges.h"

// Counts the rays of each surfel's next round: none where noise is below the bound. Returns in *any whether there are
// rays to cast.
olx_result olx_final_gather_plan(olx_scene_light *light, uint32_t round, bool *any);
// What the planned round brings to each visible surfel.
extern const olx_light_ranges olx_final_ranges;
// Adds what the round brought to the irradiance of surfels.
void olx_final_gather_settle(olx_scene_light *light);
void olx_final_gather_free(olx_scene_light *light);

#endif
