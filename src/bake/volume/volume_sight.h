// Judges whether the probes of a cell can light what is in it.
#ifndef OLX_BAKE_VOLUME_SIGHT_H
#define OLX_BAKE_VOLUME_SIGHT_H

#include "bake/volume/volume_sides.h"

// Returns whether surfaces in the cube with that low corner have places that hardly see the probes which would light
// them, as behind the edge of a window. `lift` is as for olx_volume_sides_find, which found `sides`.
bool olx_volume_is_blind(const olx_volume_space *space, olx_vec3 low, float side, float lift,
                         const olx_volume_sides *sides);

#endif
