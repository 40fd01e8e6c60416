// Decodes BC4: two bytes and three bits a texel. Where the first byte is larger, there are six values between the two;
// otherwise there are four, and 0 and 255.
#include "block/bc4.h"

uint32_t olx_bc4_texel(const olx_bc4_block *block, uint32_t texel) {
  const uint64_t bits = block->words[0] | (uint64_t)block->words[1] << 32;
  const uint32_t first = (uint32_t)bits & 255u, second = (uint32_t)(bits >> 8) & 255u;
  const uint32_t index = (uint32_t)(bits >> (16 + 3 * texel)) & 7u;
  if (index < 2) return index == 0 ? first : second;
  const uint32_t parts = first > second ? 7u : 5u, part = index - 1;
  if (part >= parts) return index == 6 ? 0 : 255;
  return (first * (parts - part) + second * part + parts / 2) / parts;
}
