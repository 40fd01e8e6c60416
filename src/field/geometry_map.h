// The geometry blocks of a light field map, the planes to which they refer, and the bounds from which pyramids are
// built.
#ifndef OLX_FIELD_GEOMETRY_MAP_H
#define OLX_FIELD_GEOMETRY_MAP_H

#include "block/geometry_block.h"
#include "field/pyramid.h"

// The blocks of a map of n x n texels, (n / 4)^2 row by row, and the planes to which they refer.
typedef struct olx_geometry_map {
  const olx_geometry_block *blocks;
  olx_plane_pool pool;
} olx_geometry_map;

// Bounds on the distances that a block's texels see anywhere over their extent: half floats in units of `scale` metres,
// rounded outwards; infinite for the sky.
typedef struct olx_distance_bounds {
  uint16_t least, greatest;
} olx_distance_bounds;

olx_distance_bounds olx_block_distances(const olx_geometry_block *block, const olx_plane_pool *pool,
                                        olx_block_place place, float scale);

// Writes the least and the greatest distance of every block of a map, (n / 4)^2 of each, from which a pyramid is built.
olx_pyramid_base olx_pyramid_over_blocks(const olx_geometry_map *map, uint32_t n, float scale, uint16_t *least,
                                         uint16_t *greatest);

#endif
