// Decodes mode 6 of BC7: seven bits a channel and one that each end's channels share, then four bits a texel, three of the first.
// Other modes are black, since the baker writes none.
#include "block/bc7.h"

#include "block/shares.h"

uint32_t olx_bc7_texel(const olx_bc7_block *block, uint32_t texel) {
  if (!olx_bc7_is_written(block)) return 0;
  const uint64_t low = block->words[0] | (uint64_t)block->words[1] << 32,
                 high = block->words[2] | (uint64_t)block->words[3] << 32;
  const uint32_t index = (uint32_t)(high >> 4 * texel) & 15u;
  const uint32_t share = olx_share_of_16(texel == 0 ? index >> 1 : index);
  uint32_t result = 0;
  for (uint32_t c = 0; c < 4; c++) {
    const uint32_t ends = (uint32_t)(low >> (7 + 14 * c)) & 0x3FFFu;
    const uint32_t from = (ends & 127u) << 1 | (uint32_t)(low >> 63), to = ends >> 7 << 1 | ((uint32_t)high & 1u);
    result |= (from * (64u - share) + to * share + 32u) >> 6 << 8 * c;
  }
  return result;
}
