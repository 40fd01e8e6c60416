// The Morton curve, along which neighbours in an array are neighbours in the map.
#ifndef OLX_BAKE_MORTON_H
#define OLX_BAKE_MORTON_H

#include <stdint.h>

// Extracts every second bit of `index`: the column of a position on the curve; the row is that of index >> 1.
static inline uint32_t olx_morton_coordinate(uint32_t index) {
  index &= 0x55555555u;
  index = (index | index >> 1) & 0x33333333u;
  index = (index | index >> 2) & 0x0F0F0F0Fu;
  index = (index | index >> 4) & 0x00FF00FFu;
  return (index | index >> 8) & 0x0000FFFFu;
}

#endif
