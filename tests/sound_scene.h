// Properties of every scene that loads, whatever its files contain.
#pragma once

#include <octalux/scene.h>

// Checks that numbers are valid, indices in range, and that rays hit the scene's triangles. A violation is reported and
// ends in abort().
void sound_scene_check(const olx_scene *scene);
// Report `what` and abort, unless `holds`.
void sound_scene_demand(bool holds, const char *what);
