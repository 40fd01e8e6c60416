// Four bytes a texel in 16 bytes a 4 x 4 texels: BC7, VK_FORMAT_BC7_UNORM_BLOCK, of which the baker writes mode 6 alone: one
// line between two colours of four channels, 16 steps.
#ifndef OLX_BLOCK_BC7_H
#define OLX_BLOCK_BC7_H

#include <octalux/base.h>

typedef struct olx_bc7_block {
  uint32_t words[4];
} olx_bc7_block;

// Whether a block is one of those that olx_bc7_texel decodes.
static inline bool olx_bc7_is_written(const olx_bc7_block *block) { return (block->words[0] & 127u) == 64u; }

// A texel, row by row from 0 to 15: red in the low byte, then green, blue and alpha. Blocks of other modes are 0.
uint32_t olx_bc7_texel(const olx_bc7_block *block, uint32_t texel);

#endif
