// Encodes light as BC6H (docs/maths.md, "Blocks").
#ifndef OLX_BLOCK_BC6H_ENCODE_H
#define OLX_BLOCK_BC6H_ENCODE_H

#include "block/bc6h.h"

// Encodes 16 texels, row by row. Negative colours and NaN count as 0, and larger ones than 65504 as 65504. The squared
// error of a texel is divided by the square of `relative_to`, a brightness such as that of all light there; NULL: the
// largest of the texel's own channels. It counts as at least a hundredth of the block's brightest light, or a
// thousandth where it is given. Texels whose bit in `counted` is 0 may get any colour; a block where none counts is
// black.
olx_bc6h_block olx_bc6h_encode(const olx_vec3 texels[16], const float relative_to[16], uint32_t counted);

#endif
