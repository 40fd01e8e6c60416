// The places for which ambient cubes are fitted, with their light: points of surfaces that light field probes see, and
// points in free space, where moving objects may be.
#ifndef OLX_EXPORT_CUBE_POINTS_H
#define OLX_EXPORT_CUBE_POINTS_H

#include "export/ambient_cubes.h"

// A point with a normal. A look-up there is the sum of shares[axis] * weights[corner] * light towards sides[axis] in
// the voxel of that corner.
typedef struct olx_cube_point {
  olx_cube_place place;
  uint32_t sides[3];
  float shares[3];     // squares of the normal's coordinates; they sum to 1
  olx_vec3 irradiance; // indirect, W/m^2
  float weight;        // of its error, above 0
  bool surface;        // it lies on a surface, not in free space
} olx_cube_point;

// Points in the order of their first voxels: those of voxel i are points[starts[i]] to points[starts[i + 1]].
typedef struct olx_cube_points {
  uint32_t count;
  olx_cube_point *points;
  uint32_t *starts; // one more than voxels
} olx_cube_points;

// Collects points for a grid: of surfaces from the maps of all probes outside geometry, evenly over each map, up to 64
// for each voxel of the grid and 2^18 in all; and 16 for each voxel in free space, up to 2^17. Points of one voxel that
// face the same way share one weight, so that nearby and distant surfaces count alike, and free space counts less than
// surfaces. The caller frees the points with olx_cube_points_free, also after a failure.
olx_result olx_cube_points_collect(const olx_field *field, const olx_cube_grid *grid, uint32_t threads,
                                   olx_cube_points *points);
void olx_cube_points_free(olx_cube_points *points);

#endif
