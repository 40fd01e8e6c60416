// The space that matters of a tile, as voxels: which of them the viewer can reach, and which allow a probe.
#ifndef OLX_PLACE_SPACE_DATA_H
#define OLX_PLACE_SPACE_DATA_H

#include "place/space/inside.h"
#include "place/space/voxels.h"
#include "place/space/world.h"

typedef struct olx_space {
  const olx_scene *scene;
  olx_world *world; // the world of the tile
  bool owns_world;
  olx_tile tile; // `voxels` are this tile's; those around its core are included because they see the core
  olx_voxels voxels;
  olx_box box;        // box that the world's voxels cover, the last of them only in part
  uint8_t *reachable; // per voxel: OLX_REACHABLE, OLX_ALLOWED, OLX_FRINGE
  size_t *starts;     // indices of the voxels that the viewer can reach, wholly or (fringe) in part, ascending
  size_t *places;     // indices of the voxels that allow a probe, ascending
  size_t reachable_count, start_count, place_count;
  int32_t outside; // depth for olx_depth_is_inside
} olx_space;

// Bits of olx_space.reachable.
enum {
  OLX_REACHABLE = 1, // the viewer can be there
  OLX_ALLOWED = 2,   // and the description allows a probe there
  OLX_FRINGE = 4     // solid, but beside a voxel that the viewer reaches
};

static inline bool olx_space_reaches(const olx_space *space, olx_vec3 p) {
  const size_t voxel = olx_voxel_at(&space->voxels, p);
  return voxel != OLX_NO_VOXEL && (space->reachable[voxel] & OLX_REACHABLE);
}

// Returns whether the surface at the point belongs to the tile rather than to a neighbour.
static inline bool olx_space_owns(const olx_space *space, olx_vec3 p) {
  return olx_world_tile_of(space->world, p) == space->tile.index;
}

// Returns whether the position is in the tile or in one of its neighbours.
static inline bool olx_space_is_near(const olx_space *space, olx_vec3 place) {
  const olx_tile at = olx_world_tile(space->world, olx_world_tile_of(space->world, place), 0);
  for (int axis = 0; axis < 3; axis++) {
    const uint32_t own = space->tile.cell[axis];
    if (at.cell[axis] + 1 < own || at.cell[axis] > own + 1) return false;
  }
  return true;
}

#endif
