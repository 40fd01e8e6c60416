// A byte a texel in 8 bytes a 4 x 4 texels: BC4, VK_FORMAT_BC4_UNORM_BLOCK; and pairs of them, BC5.
#ifndef OLX_BLOCK_BC4_H
#define OLX_BLOCK_BC4_H

#include <octalux/base.h>

typedef struct olx_bc4_block {
  uint32_t words[2];
} olx_bc4_block;

// VK_FORMAT_BC5_UNORM_BLOCK.
typedef struct olx_bc5_block {
  olx_bc4_block red, green;
} olx_bc5_block;

// A texel, row by row from 0 to 15, rounded to a whole number.
uint32_t olx_bc4_texel(const olx_bc4_block *block, uint32_t texel);

// Two of them, red in the low byte.
static inline uint16_t olx_bc5_texel(const olx_bc5_block *block, uint32_t texel) {
  return (uint16_t)(olx_bc4_texel(&block->red, texel) | olx_bc4_texel(&block->green, texel) << 8);
}

#endif
