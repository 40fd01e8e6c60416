// BC6H with unsigned half floats: light in blocks of 4 x 4 texels with 16 bytes, VK_FORMAT_BC6H_UFLOAT_BLOCK
// (docs/maths.md, "Blocks"). Texels are decoded one at a time, to what a texture unit decodes. The bits of half floats
// are interpolated, so that steps are about equal in proportion.
#ifndef OLX_BLOCK_BC6H_H
#define OLX_BLOCK_BC6H_H

#include "core/pack.h"

// A block; all zeros are black.
typedef struct olx_bc6h_block {
  uint32_t words[4];
} olx_bc6h_block;

enum {
  OLX_BC6H_CHANNELS = 3,
  OLX_BC6H_ENDS = 4, // of two lines
  OLX_BC6H_SHAPES = 32,
  OLX_BC6H_TWO_REGION_MODES = 10,
  OLX_BC6H_MOST_RUNS = 23,
  OLX_BC6H_BLACK = 3 // first word of the encoder's black block, in which no texel counts; its other words are 0
};

// A run of bits of a block: it belongs to the number `of` (channel + 3 end), from that number's bit `first` on.
typedef struct olx_bc6h_run {
  uint8_t of, first, count;
} olx_bc6h_run;

// A mode with two regions. Ends 0 and 1 belong to the first region, 2 and 3 to the second. All but the first are stored
// as differences from it, unless the mode has no bits for differences.
typedef struct olx_bc6h_mode {
  uint8_t code_bits, code; // the bits that identify the mode
  uint8_t precision, difference_bits[OLX_BC6H_CHANNELS];
  olx_bc6h_run runs[OLX_BC6H_MOST_RUNS]; // all before the shape; the last run has no bits
} olx_bc6h_mode;

extern const olx_bc6h_mode olx_bc6h_two_region_modes[OLX_BC6H_TWO_REGION_MODES];

// For each way to divide 16 texels into two regions, a bit for each texel of the second region.
extern const uint16_t olx_bc6h_shapes[OLX_BC6H_SHAPES];
// For each way to divide a block, the texel of the second region whose index has one bit less.
extern const uint8_t olx_bc6h_anchors[OLX_BC6H_SHAPES];
// Expands a quantised number of `bits` bits to 16 bits.
static inline uint32_t olx_bc6h_unquantize(uint32_t code, uint32_t bits) {
  if (bits >= 15 || code == 0) return code;
  return code == (1u << bits) - 1 ? 0xFFFFu : ((code << 16) + 0x8000u) >> bits;
}

// Returns whether a block has one of the fourteen modes.
static inline bool olx_bc6h_is_valid(const olx_bc6h_block *block) { return (block->words[0] & 19u) != 19u; }

// Decodes a texel, row by row from 0 to 15: never negative, at most 65504. Blocks of the four unused modes are black.
olx_vec3 olx_bc6h_texel(const olx_bc6h_block *block, uint32_t texel);

#endif
