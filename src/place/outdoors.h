// Free space that is connected with the viewer's but behind the scenery: outside the walls of a building with open
// windows, between a model's outer walls and its bounds.
#ifndef OLX_PLACE_OUTDOORS_H
#define OLX_PLACE_OUTDOORS_H

#include "place/space_data.h"

// Sets excluded[voxel] to 1 for the reachable voxels of such space, in small pieces, and says how many. There one sees
//   sky, and back faces rather than fronts, deeper inside surfaces than `space->outside`: behind walls;
//   much sky, when the viewer is indoors: each camera in the box sees little, or, in a scene without cameras, a good part
//   of the space does.
// Nothing in scenes that no ray leaves.
olx_result olx_find_outdoors(const olx_space *space, uint32_t threads, uint8_t *excluded, size_t *count);

#endif
