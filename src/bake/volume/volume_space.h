// The free space that the irradiance volume covers: what viewers reach, and where probes are.
#ifndef OLX_BAKE_VOLUME_SPACE_H
#define OLX_BAKE_VOLUME_SPACE_H

#include "place/space/space_find.h"

typedef struct olx_volume_space {
  const olx_scene *scene;
  olx_space space; // `reachable` is OLX_REACHABLE also where probes are
  bool *outside;   // per voxel: it and all voxels from there to a face of their box are free and not reached
  bool empty;      // there are no free voxels
} olx_volume_space;

// Floods `resolution` voxels along the longest side from the scene's cameras, as placement does, and from positions
// with flags[i] == 0. It is not an error when a scene has no such space.
olx_result olx_volume_space_create(const olx_scene *scene, const olx_vec3 *positions, const uint8_t *flags,
                                   uint32_t count, uint32_t resolution, uint32_t threads, olx_volume_space *space);
void olx_volume_space_free(olx_volume_space *space);

// Returns whether a voxel that the flood reached is in the box, or within a voxel of it.
bool olx_volume_space_touches(const olx_volume_space *space, olx_vec3 low, olx_vec3 high);
// Returns whether a place is in the volume's space: in a voxel that the flood reached or, where a surface is near, in
// sight of the middle of such a voxel beside it.
bool olx_volume_space_holds(const olx_volume_space *space, olx_vec3 place);
// Returns whether a place is outside the volume's space: beyond all voxels, in a voxel of the flood from outside or,
// where a surface is near, in sight of one. Enclosed space, such as the inside of a table's leg, does not count as
// outside.
bool olx_volume_space_shuts_out(const olx_volume_space *space, olx_vec3 place);

#endif
