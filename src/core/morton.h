// The Morton curves of the plane and of space, along which neighbours in an array are neighbours there.
#ifndef OLX_CORE_MORTON_H
#define OLX_CORE_MORTON_H

#include <stdint.h>

// Extracts every second bit of `index`: the column of a position on the curve of the plane. The row is the column of
// index >> 1.
static inline uint32_t olx_morton_coordinate(uint32_t index) {
  index &= 0x55555555u;
  index = (index | index >> 1) & 0x33333333u;
  index = (index | index >> 2) & 0x0F0F0F0Fu;
  index = (index | index >> 4) & 0x00FF00FFu;
  return (index | index >> 8) & 0x0000FFFFu;
}

// Spreads the lowest 21 bits of a coordinate so that they occupy every third bit, from bit 0. The index on the curve of
// space is x's, y's << 1 and z's << 2 together.
static inline uint64_t olx_morton_spread(uint64_t x) {
  x &= 0x1FFFFFu;
  x = (x | x << 32) & 0x1F00000000FFFFu;
  x = (x | x << 16) & 0x1F0000FF0000FFu;
  x = (x | x << 8) & 0x100F00F00F00F00Fu;
  x = (x | x << 4) & 0x10C30C30C30C30C3u;
  return (x | x << 2) & 0x1249249249249249u;
}

#endif
