// Free space that is connected with the viewer's but lies behind the scenery: outside the walls of a building with open
// windows, or between a model's outer walls and its bounds.
#ifndef OLX_PLACE_OUTDOORS_H
#define OLX_PLACE_OUTDOORS_H

#include "place/space/space_data.h"

#define OLX_OUTDOOR_SKY 0.4f // least sky visible from an outdoor position, as a share of directions

// Returns whether the viewer is indoors, where little sky is visible: by every camera in the box or, in a scene without
// cameras, by a good part of the space of all tiles, of which *indoor of *pieces are indoors. Both counts are added to.
bool olx_cameras_are_indoors(const olx_world *world);
olx_result olx_count_indoors(const olx_space *space, uint32_t threads, uint64_t *pieces, uint64_t *indoor);
static inline bool olx_pieces_are_indoors(uint64_t pieces, uint64_t indoor) { return 4 * indoor >= pieces; }

// Sets excluded[voxel] to 1 for reachable voxels where no viewer is, in small pieces of the tile's core. A piece is
// excluded when it lies behind walls: from its middle one sees sky, more back faces than front faces, and it is deeper
// inside surfaces than `space->outside`. When the viewer is indoors, a piece that sees much sky is excluded as well. No
// voxels are excluded in scenes that no ray leaves.
olx_result olx_find_outdoors(const olx_space *space, bool indoors, uint32_t threads, uint8_t *excluded);

#endif
