// The free space that the irradiance volume covers: what viewers reach, and where probes are.
#ifndef OLX_BAKE_VOLUME_SPACE_H
#define OLX_BAKE_VOLUME_SPACE_H

#include "place/space_find.h"

typedef struct olx_volume_space {
  const olx_scene *scene;
  olx_space space; // `reachable` is OLX_REACHABLE also where probes are
  bool *outside;   // a voxel: free, not reached, and so are voxels from there to a face of their box
  bool empty;      // nothing is free
} olx_volume_space;

// Floods `resolution` voxels along the longest side from the scene's cameras, as placement does, and from positions
// with flags[i] == 0. A scene without such space is no error.
olx_result olx_volume_space_create(const olx_scene *scene, const olx_vec3 *positions, const uint8_t *flags,
                                   uint32_t count, uint32_t resolution, uint32_t threads, olx_volume_space *space);
void olx_volume_space_free(olx_volume_space *space);

// Returns whether a voxel that the flood reached is in the box, or within a voxel of it.
bool olx_volume_space_touches(const olx_volume_space *space, olx_vec3 low, olx_vec3 high);
// Returns whether a place is in that space: in such a voxel, or where a surface is near, in sight of the middle of one
// beside it.
bool olx_volume_space_holds(const olx_volume_space *space, olx_vec3 place);
// Returns whether a place is not, but beyond all voxels, or in the same way in voxels outside. What is shut in, such as
// the inside of a table's leg, is not shut out.
bool olx_volume_space_shuts_out(const olx_volume_space *space, olx_vec3 place);

#endif
