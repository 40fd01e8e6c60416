// Which of a world's free voxels the viewer reaches.
#ifndef OLX_PLACE_SPACE_FIND_H
#define OLX_PLACE_SPACE_FIND_H

#include "place/space.h"

enum {
  OLX_TILE_EDGE = 128,  // voxels along a tile, where there are several,
  OLX_TILE_OVERLAP = 16 // and around it those that are opened with it
};
// What the settings of a placement say about numbers of samples is for so many voxels of space, where there are several
// tiles.
#define OLX_SETTINGS_VOXELS ((double)(1u << 20))

// The space that matters is flooded from the cameras (one outside the box enters it where it looks) and from pinned
// probes. Without a camera that can enter: all of the playable box that is not inside geometry, or, without a box, the
// largest such space that light reaches. Without a playable box what lies behind the scenery (outdoors.h) is left out.
//
// The box that is flooded: the playable one, as far as it is near the scene, or the scene's bounds. OLX_ERROR_EMPTY
// when it holds no volume.
olx_result olx_space_box(const olx_scene *scene, olx_box *box);
// Find the space in one tile, with `resolution` voxels along its longest side. OLX_ERROR_EMPTY when there is none.
olx_result olx_world_create_small(const olx_scene *scene, uint32_t resolution, uint32_t threads, olx_world *world);
// Find it in tiles of space, of voxels of a size in metres, which is doubled until they are few enough.
olx_result olx_world_create_tiled(const olx_scene *scene, float size, uint32_t threads, olx_world *world);
// A small world and its only tile, which owns it.
olx_result olx_space_create(const olx_scene *scene, uint32_t resolution, uint32_t threads, olx_space *space);

#endif
