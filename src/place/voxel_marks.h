// Which cubes of a lattice a scene's surfaces touch.
#ifndef OLX_PLACE_VOXEL_MARKS_H
#define OLX_PLACE_VOXEL_MARKS_H

#include "scene/scene_data.h"

// Cube (x, y, z) has its low corner at low + (x, y, z) * size.
typedef struct olx_lattice {
  olx_vec3 low;
  float size, slack; // slack: by which cubes are grown against rounding, as a share of their size
  uint32_t count[3];
} olx_lattice;

// Called for a cube that a surface touches, from any thread, several times or several at once for one cube.
typedef void (*olx_mark_cell)(void *user, const int32_t cell[3]);

// Mark every cube that a triangle touches, conservatively; of an alpha-masked one those alone where its surface is
// there.
olx_result olx_mark_cells(const olx_scene *scene, const olx_lattice *lattice, uint32_t threads, olx_mark_cell mark,
                          void *user);

#endif
