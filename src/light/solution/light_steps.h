// The steps by which a scene's light is solved; light_units.h runs them.
#ifndef OLX_LIGHT_LIGHT_STEPS_H
#define OLX_LIGHT_LIGHT_STEPS_H

#include "light/solution/light_solution.h"

// The parts of the solution: the first step, which finds surfaces; the direct light of a range of surfels; and the
// steps that follow once the rays of a round, or direct light, are complete.
olx_result olx_scene_light_begin(olx_scene_light *light);
olx_result olx_scene_light_direct(olx_scene_light *light, uint32_t first, uint32_t count, uint64_t *rays);
olx_result olx_scene_light_settle(olx_scene_light *light);
// Releases the solution's data.
void olx_scene_light_clear(olx_scene_light *light);

#endif
