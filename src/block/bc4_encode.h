// Encodes maps of one byte per texel as BC4.
#ifndef OLX_BLOCK_BC4_ENCODE_H
#define OLX_BLOCK_BC4_ENCODE_H

#include "block/bc4.h"

// Encodes 16 texels, row by row; texels whose bit in `counted` is 0 may get any number.
olx_bc4_block olx_bc4_encode(const uint8_t texels[16], uint32_t counted);

#endif
