// The steps of solving a scene's light as units that a store can hold.
//
// Steps follow each other: rays of a round are cast, then one job settles what they found and decides on the next
// round. Casting is many units, settling one, whose result is all that is known but links.
#ifndef OLX_LIGHT_LIGHT_UNITS_H
#define OLX_LIGHT_LIGHT_UNITS_H

#include "light/light_solution.h"

// Makes the table by which surfels are found, or loads it.
olx_result olx_light_units_look_up(olx_scene_light *light);

// Runs all steps, or loads what the store has of them.
olx_result olx_light_units_run(olx_scene_light *light);

// Brings links and points into memory, where the solution was loaded without them (scene_light.h).
olx_result olx_light_units_load_links(olx_scene_light *light);

#endif
