// BC1 without transparency: three bytes a texel in blocks of 4 x 4 texels with 8 bytes, VK_FORMAT_BC1_RGB_UNORM_BLOCK.
#ifndef OLX_BLOCK_BC1_H
#define OLX_BLOCK_BC1_H

#include <octalux/base.h>

typedef struct olx_bc1_block {
  uint32_t words[2];
} olx_bc1_block;

// Decodes a texel, row by row from 0 to 15: red in the low byte, then green and blue, rounded to whole numbers.
uint32_t olx_bc1_texel(const olx_bc1_block *block, uint32_t texel);

#endif
