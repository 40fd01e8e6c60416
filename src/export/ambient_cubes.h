// Ambient cubes (Mitchell 2006, "Shading in Valve's Source Engine"): irradiance towards the six axes in voxels of a
// box. An engine looks them up by trilinear interpolation of the voxels' centres, whatever lies between them, and
// blends the axes by the squares of the normal's coordinates.
#ifndef OLX_EXPORT_AMBIENT_CUBES_H
#define OLX_EXPORT_AMBIENT_CUBES_H

#include "core/vec.h"

#include <octalux/field.h>

enum { OLX_CUBE_SIDES = 6, OLX_CUBE_POINT_VOXELS = 8 };

// The voxels of a box. Voxel (x, y, z) has the index x + size[0] * (y + size[1] * z) and the centre
// low + (x + 1/2, y + 1/2, z + 1/2) * spacing.
typedef struct olx_cube_grid {
  olx_vec3 low;     // metres, relative to the field's origin
  olx_vec3 spacing; // metres, above 0
  uint32_t size[3];
} olx_cube_grid;

static inline size_t olx_cube_voxels(const olx_cube_grid *g) { return (size_t)g->size[0] * g->size[1] * g->size[2]; }

// Returns the side that a surface whose normal has this coordinate reads along an axis: 0 to 5 are +x, -x, +y, -y, +z
// and -z.
static inline uint32_t olx_cube_side(uint32_t axis, float coordinate) { return 2 * axis + (coordinate < 0.0f ? 1 : 0); }

// What a look-up reads at a place: eight voxels with their weights, which sum to 1.
typedef struct olx_cube_place {
  uint32_t first; // the voxel with the smallest index
  float
      weights[OLX_CUBE_POINT_VOXELS]; // bit 0 of a corner is x, bit 1 is y, bit 2 is z; 0 for a voxel outside the grid
} olx_cube_place;

olx_cube_place olx_cube_place_at(const olx_cube_grid *grid, olx_vec3 position);

// Distances between the indices of the eight voxels of a place and the first.
typedef struct olx_cube_steps {
  uint32_t corner[OLX_CUBE_POINT_VOXELS];
} olx_cube_steps;

olx_cube_steps olx_cube_steps_of(const olx_cube_grid *grid);

// Light in W/m^2 towards a side in a voxel is values[side * voxels + voxel].
typedef struct olx_cubes {
  olx_cube_grid grid;
  size_t voxels;
  olx_vec3 *values;
  bool *served; // for each voxel: whether the field's volume has a cell at its centre
} olx_cubes;

// Reserves memory for the values and sets none of them. The caller frees it with olx_cubes_free, also after a failure.
olx_result olx_cubes_create(const olx_cube_grid *grid, olx_cubes *cubes);
void olx_cubes_free(olx_cubes *cubes);

// Sets every voxel to what the field's irradiance volume says at its centre. A centre without light, which is inside
// geometry, gets the mean of its neighbours, and so on from voxel to voxel. Fails when no voxel has light.
olx_result olx_cubes_capture(const olx_field *field, olx_cubes *cubes, uint32_t threads);

#endif
