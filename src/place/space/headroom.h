// Measures the height of a scene's rooms, from which the size of voxels follows: fine enough for doors, whatever the
// model's unit of length.
#ifndef OLX_PLACE_HEADROOM_H
#define OLX_PLACE_HEADROOM_H

#include "scene/scene_data.h"

// Returns the median distance in metres from floors to what is above them, over floors by area; 0 where less than a
// tenth of them have anything above.
float olx_headroom(const olx_scene *scene);

#endif
