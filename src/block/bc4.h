// BC4, a byte a texel in blocks of 4 x 4 texels with 8 bytes, VK_FORMAT_BC4_UNORM_BLOCK; and BC5, a pair of such
// blocks.
#ifndef OLX_BLOCK_BC4_H
#define OLX_BLOCK_BC4_H

#include <octalux/base.h>

typedef struct olx_bc4_block {
  uint32_t words[2];
} olx_bc4_block;

// A block of two channels, VK_FORMAT_BC5_UNORM_BLOCK.
typedef struct olx_bc5_block {
  olx_bc4_block red, green;
} olx_bc5_block;

// Decodes a texel, row by row from 0 to 15, rounded to a whole number.
uint32_t olx_bc4_texel(const olx_bc4_block *block, uint32_t texel);

// Decodes both channels of a texel, red in the low byte.
static inline uint16_t olx_bc5_texel(const olx_bc5_block *block, uint32_t texel) {
  return (uint16_t)(olx_bc4_texel(&block->red, texel) | olx_bc4_texel(&block->green, texel) << 8);
}

#endif
