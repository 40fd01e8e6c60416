// The pyramids over a probe's distances (Wang 2018, section 4.3): the smallest distance in squares of 4, 16, 64, 256
// texels a side, and the largest in squares from 16 on. docs/format.md gives their layout, which is the same in the
// file and in memory.
#ifndef OLX_FIELD_PYRAMID_H
#define OLX_FIELD_PYRAMID_H

#include "shaders/octalux_shared.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { OLX_PYRAMID_MAX_LEVELS = 4 };

// Level 0 is the finest; every level above it has at least four nodes a side.
typedef struct olx_pyramid_shape {
  uint32_t levels;
  uint32_t side[OLX_PYRAMID_MAX_LEVELS];  // nodes along a side of a level
  uint32_t first[OLX_PYRAMID_MAX_LEVELS]; // where the level begins in the record of a probe: the coarsest comes first
  uint32_t least_level;                   // the finest level of smallest distances
  uint32_t least_nodes;                   // in a probe's record of smallest distances
  uint32_t greatest_level;                // the finest level of largest distances: 1, or 0 when there is only one level
  uint32_t greatest_nodes;                // in a probe's record of largest distances
} olx_pyramid_shape;

// Returns the shape of the pyramids for maps of n x n texels. Geometry blocks are nodes of level 0 themselves, so over
// them both pyramids begin with the level of largest distances.
olx_pyramid_shape olx_pyramid_shape_of(uint32_t n, bool over_blocks);

// Returns log2 of the texels along the side of a node.
static inline uint32_t olx_pyramid_shift(uint32_t level) { return OLX_PYRAMID_FINEST + OLX_PYRAMID_STEP * level; }

// Returns the index of a node within its level. Tiles of 4 x 4 nodes keep the children of one parent together.
static inline uint32_t olx_pyramid_index(uint32_t side, uint32_t x, uint32_t y) {
  if (side < 4) return y * side + x;
  return ((y >> 2) * (side >> 2) + (x >> 2)) * 16 + (y & 3u) * 4 + (x & 3u);
}

// The distances from which a pyramid is built, as bits of half floats: squares of 2^shift texels a side, row by row
// from texel (0, 0) on, rows `stride` apart. Texels have shift 0 and one array for both bounds, perhaps within a
// border; their sign is ignored.
typedef struct olx_pyramid_base {
  const uint16_t *least, *greatest;
  uint32_t stride, shift;
} olx_pyramid_base;

static inline olx_pyramid_base olx_pyramid_over_texels(const uint16_t *distance, uint32_t stride) {
  return (olx_pyramid_base){distance, distance, stride, 0};
}

// Returns the value of a node. Above its pyramid's finest level it is computed from its children in `nodes`.
uint16_t olx_pyramid_least(const olx_pyramid_shape *shape, const olx_pyramid_base *base, const uint16_t *nodes,
                           uint32_t level, uint32_t x, uint32_t y);
uint16_t olx_pyramid_greatest(const olx_pyramid_shape *shape, const olx_pyramid_base *base, const uint16_t *nodes,
                              uint32_t level, uint32_t x, uint32_t y);

// Writes the pyramids of smallest and of largest distances of a probe.
void olx_pyramid_make(const olx_pyramid_shape *shape, const olx_pyramid_base *base, uint16_t *least,
                      uint16_t *greatest);

#endif
