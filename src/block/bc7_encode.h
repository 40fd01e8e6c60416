// Encodes four bytes a texel as mode 6 of BC7.
#ifndef OLX_BLOCK_BC7_ENCODE_H
#define OLX_BLOCK_BC7_ENCODE_H

#include "block/bc7.h"

// Encodes 16 texels, row by row, red in the low byte. Squared errors count by the weights of the channels, which are above 0; those
// whose bit in `counted` is 0 may get any colour.
olx_bc7_block olx_bc7_encode(const uint32_t texels[16], const float weights[4], uint32_t counted);

#endif
