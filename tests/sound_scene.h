// What every scene that loads must be, whatever its files held.
#pragma once

#include <octalux/scene.h>

// Numbers in order, indices in range, rays that find what is there. What does not hold is reported and ends in abort().
void sound_scene_check(const olx_scene *scene);
// Report `what` and abort, unless it holds.
void sound_scene_demand(bool holds, const char *what);
