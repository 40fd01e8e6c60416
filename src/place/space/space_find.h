// Finds which of a world's free voxels the viewer can reach.
#ifndef OLX_PLACE_SPACE_FIND_H
#define OLX_PLACE_SPACE_FIND_H

#include "place/space/space.h"

enum {
  OLX_TILE_EDGE = 128,  // voxels along an edge of a tile, where there are several
  OLX_TILE_OVERLAP = 16 // voxels around a tile that are opened with it
};
// With several tiles, numbers of samples in the settings of a placement are per this many voxels of space.
#define OLX_SETTINGS_VOXELS ((double)(1u << 20))

// The next two functions flood the box of interest (space_box.h). The flood begins at the cameras (a camera outside the
// box enters where it looks) and at pinned probes. Without a camera that can enter, it fills all of the playable box
// that is not inside geometry or, without a box, every such space that light reaches, except for crumbs, or the largest
// where it reaches none. Without a playable box, space behind the scenery (outdoors.h) is excluded.
//
// Finds the space in one tile, with `resolution` voxels along its longest side. Returns OLX_ERROR_EMPTY when there is
// none.
olx_result olx_world_create_small(const olx_scene *scene, uint32_t resolution, uint32_t threads, olx_world *world);
// Finds the space in many tiles, with voxels of a size in metres that is doubled until there are few enough.
olx_result olx_world_create_tiled(const olx_scene *scene, float size, uint32_t threads, olx_world *world);
// Creates a world of one tile and opens the tile, which owns the world.
olx_result olx_space_create(const olx_scene *scene, uint32_t resolution, uint32_t threads, olx_space *space);

#endif
