// Light in 16 bytes a 4 x 4 texels: BC6H with unsigned half floats, VK_FORMAT_BC6H_UFLOAT_BLOCK. What a texture unit
// makes of a block, a texel at a time (docs/maths.md, "Blocks"). Interpolated numbers are the bits of half floats, so
// that steps are about equal in proportion.
#ifndef OLX_BLOCK_BC6H_H
#define OLX_BLOCK_BC6H_H

#include "core/pack.h"

// Zeros are black.
typedef struct olx_bc6h_block {
  uint32_t words[4];
} olx_bc6h_block;

enum {
  OLX_BC6H_CHANNELS = 3,
  OLX_BC6H_ENDS = 4, // of two lines
  OLX_BC6H_SHAPES = 32,
  OLX_BC6H_TWO_REGION_MODES = 10,
  OLX_BC6H_MOST_RUNS = 23,
  OLX_BC6H_BLACK = 3 // first word of the block that the encoder makes of nothing; the others are 0
};

// Where bits of a block go: to the number `of` (channel + 3 end), from its bit `first` on.
typedef struct olx_bc6h_run {
  uint8_t of, first, count;
} olx_bc6h_run;

// A mode with two regions. Ends 0 and 1 are of the first region, 2 and 3 of the second; all but the first are
// differences from that one, unless they have no bits.
typedef struct olx_bc6h_mode {
  uint8_t code_bits, code; // that name the mode
  uint8_t precision, difference_bits[OLX_BC6H_CHANNELS];
  olx_bc6h_run runs[OLX_BC6H_MOST_RUNS]; // up to the shape; the last has no bits
} olx_bc6h_mode;

extern const olx_bc6h_mode olx_bc6h_two_region_modes[OLX_BC6H_TWO_REGION_MODES];

// For each way to divide 16 texels into two regions, a bit for each texel of the second one.
extern const uint16_t olx_bc6h_shapes[OLX_BC6H_SHAPES];
// The texel of the second region whose index has one bit less.
extern const uint8_t olx_bc6h_anchors[OLX_BC6H_SHAPES];
// A quantised number of so many bits as 16 bits.
static inline uint32_t olx_bc6h_unquantize(uint32_t code, uint32_t bits) {
  if (bits >= 15 || code == 0) return code;
  return code == (1u << bits) - 1 ? 0xFFFFu : ((code << 16) + 0x8000u) >> bits;
}

// Whether a block is of one of the fourteen modes.
static inline bool olx_bc6h_is_valid(const olx_bc6h_block *block) { return (block->words[0] & 19u) != 19u; }

// A texel, row by row from 0 to 15: never negative, at most 65504. Blocks of the four unused modes are black.
olx_vec3 olx_bc6h_texel(const olx_bc6h_block *block, uint32_t texel);

#endif
