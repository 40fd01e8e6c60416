// Final gathering: where links for enough rays do not fit into memory, surfels cast rays that leave none once the light
// is solved. Each brings what surfels pass on, and sums alone are kept, so that time instead of memory bounds noise.
#ifndef OLX_LIGHT_FINAL_GATHER_H
#define OLX_LIGHT_FINAL_GATHER_H

#include "light/solution/light_solution.h"

// Counts the rays of each surfel's next round: none where noise is below the bound. Returns in *any whether there are
// rays to cast.
olx_result olx_final_gather_plan(olx_scene_light *light, uint32_t round, bool *any);
// Returns the number of units of the planned round, whose surfels follow each other.
uint32_t olx_final_gather_units(const olx_scene_light *light);
// Returns the first surfel of a unit; of that after the last, the number of visible surfels.
uint32_t olx_final_gather_first(const olx_scene_light *light, uint32_t unit);
// Makes room for what the planned round brings. Has no effect where there is room.
olx_result olx_final_gather_make_room(olx_scene_light *light);
// Casts the rays of surfels first to end - 1, and counts them in *rays.
olx_result olx_final_gather_cast(olx_scene_light *light, uint32_t first, uint32_t end, uint64_t *rays);
// Adds what the round brought to the irradiance of surfels.
void olx_final_gather_settle(olx_scene_light *light);
void olx_final_gather_free(olx_scene_light *light);

#endif
