// Which of a world's free voxels the viewer reaches.
#ifndef OLX_PLACE_SPACE_FIND_H
#define OLX_PLACE_SPACE_FIND_H

#include "place/space.h"

// Flood the world from its cameras (one outside the box enters it where it looks) and from pinned probes. Without a camera that
// can enter: all of the playable box that is not inside geometry, or, without a box, the largest such space that light reaches.
// Without a playable box what lies behind the scenery (outdoors.h) is left out. OLX_ERROR_EMPTY when nothing is reached.
olx_result olx_world_find_space(olx_world *world, uint32_t threads);

// The box to look at: the description's playable one, as far as it is near the scene, or the scene's bounds. OLX_ERROR_EMPTY
// when it holds no volume.
olx_result olx_space_box(const olx_scene *scene, olx_box *box);
// Find the space that matters over that box, in one tile with `resolution` voxels along its longest side.
// OLX_ERROR_EMPTY when there is none.
olx_result olx_space_create(const olx_scene *scene, uint32_t resolution, uint32_t threads, olx_space *space);

#endif
