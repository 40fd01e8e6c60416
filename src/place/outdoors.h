// Free space that is connected with the viewer's but behind the scenery: outside the walls of a building with open
// windows, between a model's outer walls and its bounds.
#ifndef OLX_PLACE_OUTDOORS_H
#define OLX_PLACE_OUTDOORS_H

#include "place/space_data.h"

#define OLX_OUTDOOR_SKY 0.4f // share of directions that leave the scene, of an outdoor place

// Whether the viewer stays where little sky is seen: each camera in the box sees little, or, in a scene without
// cameras, a good part of the space does, in all tiles together: *pieces of it, of which *indoor are. Both are added
// to.
bool olx_cameras_are_indoors(const olx_world *world);
olx_result olx_count_indoors(const olx_space *space, uint32_t threads, uint64_t *pieces, uint64_t *indoor);
static inline bool olx_pieces_are_indoors(uint64_t pieces, uint64_t indoor) { return 4 * indoor >= pieces; }

// Sets excluded[voxel] to 1 for the reachable voxels of such space, in small pieces of the tile's core. There one sees
//   sky, and back faces rather than fronts, deeper inside surfaces than `space->outside`: behind walls;
//   much sky, when the viewer is indoors.
// Nothing in scenes that no ray leaves.
olx_result olx_find_outdoors(const olx_space *space, bool indoors, uint32_t threads, uint8_t *excluded);

#endif
