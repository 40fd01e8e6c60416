// Encodes BC4 between the least and the largest number of a block, moved inwards by least squares where that is better.
// An exact zero stays exact, because the ends are exact.
#include "block/bc4_encode.h"

#include "block/line_encode.h"

#include <stdlib.h>

enum { TEXELS = 16 };

static const olx_line_steps STEPS = {1, 7.0f, 7.0f};

// Codes the block with these ends, of which the first is the larger, and returns the sum of its squared errors.
static uint32_t code(const uint8_t *texels, uint32_t counted, uint32_t first, uint32_t second, olx_bc4_block *block) {
  const int32_t range = (int32_t)first - (int32_t)second;
  uint64_t bits = first | second << 8;
  uint32_t error = 0;
  for (uint32_t i = 0; i < TEXELS; i++) {
    const int32_t above = (int32_t)texels[i] - (int32_t)second;
    const int32_t wanted = range > 0 ? (14 * above + range) / (2 * range) : 0;
    const int32_t step = 7 - (above < 0 ? 0 : wanted > 7 ? 7 : wanted); // from the first
    const int32_t value = ((int32_t)first * (7 - step) + (int32_t)second * step + 3) / 7;
    const uint32_t index = step == 0 ? 0u : step == 7 ? 1u : (uint32_t)step + 1u;
    bits |= (uint64_t)index << (16 + 3 * i);
    if (counted >> i & 1u) error += (uint32_t)((value - texels[i]) * (value - texels[i]));
  }
  *block = (olx_bc4_block){{(uint32_t)bits, (uint32_t)(bits >> 32)}};
  return error;
}

static olx_line refined_ends(const uint8_t *texels, uint32_t counted, uint32_t most, uint32_t least) {
  olx_line_colours s;
  for (uint32_t i = 0; i < TEXELS; i++) {
    const float on = (float)(counted >> i & 1u);
    s.on[i / 4][i % 4] = s.weight[0][i / 4][i % 4] = on;
    s.place[0][i / 4][i % 4] = (float)texels[i];
  }
  olx_line l = {{(float)most}, {(float)least}};
  olx_line_refine(&s, STEPS, &l);
  return l;
}

olx_bc4_block olx_bc4_encode(const uint8_t texels[16], uint32_t counted) {
  uint32_t most = 0, least = 255;
  for (uint32_t i = 0; i < TEXELS; i++) {
    if (!(counted >> i & 1u)) continue;
    most = texels[i] > most ? texels[i] : most;
    least = texels[i] < least ? texels[i] : least;
  }
  if (most <= least) return (olx_bc4_block){{(most | most << 8) * (most == least), 0}};
  olx_bc4_block plain, refined;
  const uint32_t error = code(texels, counted, most, least, &plain);
  if (error == 0) return plain;
  const olx_line l = refined_ends(texels, counted, most, least);
  const uint32_t first = (uint32_t)(olx_clamp(l.from[0], 0.0f, 255.0f) + 0.5f),
                 second = (uint32_t)(olx_clamp(l.to[0], 0.0f, 255.0f) + 0.5f);
  if (first <= second) return plain;
  return code(texels, counted, first, second, &refined) < error ? refined : plain;
}
