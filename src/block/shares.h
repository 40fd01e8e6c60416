// The shares of a line's second end in 64ths, by a texel's index: those of BC6H and BC7.
#ifndef OLX_BLOCK_SHARES_H
#define OLX_BLOCK_SHARES_H

#include <octalux/base.h>

static inline uint32_t olx_share_of_16(uint32_t index) { return (64 * index + 7) / 15; }
static inline uint32_t olx_share_of_8(uint32_t index) { return (64 * index + 3) / 7; }

#endif
