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

// Mark every cube that a triangle touches, conservatively. Of an alpha-masked one only those cubes are marked in which
// samples find its surface present, or with `whole` all of them: samples that are too far apart for large cubes would
// miss some.
olx_result olx_mark_cells(const olx_scene *scene, const olx_lattice *lattice, bool whole, uint32_t threads,
                          olx_mark_cell mark, void *user);

#endif
