// Solves a scene's light by steps whose results are units that a store can hold.
//
// Steps follow each other: the rays of a round are cast, then one job settles what they found and decides on the next
// round. Casting consists of many units, settling of one, whose result is the whole state except links.
#ifndef OLX_LIGHT_LIGHT_UNITS_H
#define OLX_LIGHT_LIGHT_UNITS_H

#include "light/solution/light_solution.h"

// Builds the lookup of records, or loads it.
olx_result olx_light_units_look_up(olx_scene_light *light);

// Runs all steps, or loads those that are stored.
olx_result olx_light_units_run(olx_scene_light *light);

// Runs the steps that find surfels, without a store, up to the one that lights them.
olx_result olx_light_units_explore(olx_scene_light *light);

// Loads links and points into memory, where the solution was loaded without them (scene_light.h).
olx_result olx_light_units_load_links(olx_scene_light *light);

#endif
