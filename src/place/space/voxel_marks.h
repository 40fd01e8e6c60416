// Finds which cubes of a lattice a scene's surfaces touch.
#ifndef OLX_PLACE_VOXEL_MARKS_H
#define OLX_PLACE_VOXEL_MARKS_H

#include "scene/scene_data.h"

// A lattice of cubes: cube (x, y, z) has its low corner at low + (x, y, z) * size.
typedef struct olx_lattice {
  olx_vec3 low;
  float size, slack; // slack: margin by which cubes are grown against rounding, as a share of their size
  uint32_t count[3];
} olx_lattice;

// Receives a cube that a surface touches. It is called from any thread, possibly several times or concurrently for the
// same cube.
typedef void (*olx_mark_cell)(void *user, const int32_t cell[3]);

// Marks every cube that a triangle touches, conservatively. For an alpha-masked triangle only cubes in which samples
// find its surface opaque are marked, or with `whole` all that it touches: samples are too far apart for large cubes.
olx_result olx_mark_cells(const olx_scene *scene, const olx_lattice *lattice, bool whole, uint32_t threads,
                          olx_mark_cell mark, void *user);

#endif
