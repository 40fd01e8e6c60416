// Encodes three bytes a texel as BC1.
#ifndef OLX_BLOCK_BC1_ENCODE_H
#define OLX_BLOCK_BC1_ENCODE_H

#include "block/bc1.h"

// Encodes 16 texels, row by row, red in the low byte; texels whose bit in `counted` is 0 may get any colour.
olx_bc1_block olx_bc1_encode(const uint32_t texels[16], uint32_t counted);

#endif
