// Decodes BC1: two colours of 5, 6 and 5 bits, and two bits a texel. Where the first colour's number is not larger than
// the second's, a texel takes one of the two, their mean, or black.
#include "block/bc1.h"

static uint32_t channel(uint32_t color, uint32_t c) {
  const uint32_t five = color >> (c == 0 ? 11 : 0) & 31u, six = color >> 5 & 63u;
  return c == 1 ? six << 2 | six >> 4 : five << 3 | five >> 2;
}

uint32_t olx_bc1_texel(const olx_bc1_block *block, uint32_t texel) {
  static const uint8_t THIRDS[4] = {0, 3, 1, 2};
  const uint32_t first = block->words[0] & 0xFFFFu, second = block->words[0] >> 16;
  const uint32_t index = block->words[1] >> 2 * texel & 3u;
  uint32_t result = 0;
  for (uint32_t c = 0; c < 3; c++) {
    const uint32_t from = channel(first, c), to = channel(second, c);
    const uint32_t of_four = (from * (3u - THIRDS[index]) + to * THIRDS[index] + 1u) / 3u;
    const uint32_t of_three = index == 0 ? from : index == 1 ? to : index == 2 ? (from + to + 1u) / 2u : 0;
    result |= (first > second ? of_four : of_three) << 8 * c;
  }
  return result;
}
