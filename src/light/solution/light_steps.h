// The steps by which a scene's light is solved; light_units.h runs them.
#ifndef OLX_LIGHT_LIGHT_STEPS_H
#define OLX_LIGHT_LIGHT_STEPS_H

#include "light/solution/light_ranges.h"

// The first step, which finds surfaces.
olx_result olx_scene_light_begin(olx_scene_light *light);
// The step that follows once the rays of a round, or the array of one, are complete.
olx_result olx_scene_light_settle(olx_scene_light *light);
// Releases the solution's data.
void olx_scene_light_clear(olx_scene_light *light);

#endif
