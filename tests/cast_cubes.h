// Cube maps of what probes see, by a ray through the middle of each texel: what a raster of octalux/bake.h must find.
#ifndef OLX_TESTS_CAST_CUBES_H
#define OLX_TESTS_CAST_CUBES_H

#include "scene/ray.h"
#include "scene/scene_data.h"

#include <octalux/bake.h>

// Returns the ray through the middle of a texel, as olx_bake_raster.look defines it; `texel` is its index in the cube.
olx_ray cast_cube_ray(olx_vec3 position, uint32_t side, size_t texel);

// Returns a raster that casts rays through the scene, which is its `user`.
olx_bake_raster cast_cube_raster(const olx_scene *scene);

#endif
