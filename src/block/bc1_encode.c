// Encodes BC1: fits a line through the texels' colours by least squares; encodes a single colour as the pair that is
// nearest to it in thirds. Blocks have four colours, never black for transparency.
#include "block/bc1_encode.h"

#include "block/line_encode.h"

#include <stdlib.h>

enum { CHANNELS = 3, TEXELS = 16, REFINEMENTS = 2 };

static const olx_line_steps STEPS = {CHANNELS, 3.0f, 3.0f};
static const uint32_t MOST[CHANNELS] = {31, 63, 31};

static void load(olx_line_colours *s, const uint32_t *texels, uint32_t counted) {
  for (uint32_t i = 0; i < TEXELS; i++) {
    const float on = (float)(counted >> i & 1u);
    s->on[i / 4][i % 4] = on;
    for (uint32_t k = 0; k < CHANNELS; k++) {
      s->place[k][i / 4][i % 4] = on * (float)(texels[i] >> 8 * k & 255u);
      s->weight[k][i / 4][i % 4] = on;
    }
  }
}

static int32_t expand(uint32_t code, uint32_t k) {
  return (int32_t)(k == 1 ? code << 2 | code >> 4 : code << 3 | code >> 2);
}

static uint32_t quantize(float value, uint32_t k) {
  return (uint32_t)(olx_clamp(value, 0.0f, 255.0f) * (1.0f / 255.0f) * (float)MOST[k] + 0.5f);
}

// Finds two codes near a value for which two thirds of the first plus one third of the second come nearest to the
// value.
static void single(float value, uint32_t k, uint32_t codes[2]) {
  const int32_t near = (int32_t)quantize(value, k);
  float least = INFINITY;
  for (int32_t from = near - 2; from <= near + 2; from++) {
    for (int32_t to = near - 2; to <= near + 2; to++) {
      if (from < 0 || to < 0 || from > (int32_t)MOST[k] || to > (int32_t)MOST[k]) continue;
      const int32_t mixed = (2 * expand((uint32_t)from, k) + expand((uint32_t)to, k) + 1) / 3;
      const float off = fabsf((float)mixed - value) + 0.01f * (float)abs(from - to);
      if (off >= least) continue;
      least = off;
      codes[0] = (uint32_t)from;
      codes[1] = (uint32_t)to;
    }
  }
}

static olx_bc1_block write_block(uint32_t first, uint32_t second, const int32_t index[TEXELS]) {
  static const uint8_t CODES[4] = {0, 2, 3, 1};
  const bool turned = first < second;
  olx_bc1_block block = {{turned ? second | first << 16 : first | second << 16, 0}};
  if (first == second) return block; // the block has three colours, of which the first is the wanted one
  for (uint32_t i = 0; i < TEXELS; i++) {
    block.words[1] |= (uint32_t)CODES[turned ? 3 - index[i] : index[i]] << 2 * i;
  }
  return block;
}

static uint32_t packed(const uint32_t codes[CHANNELS]) { return codes[0] << 11 | codes[1] << 5 | codes[2]; }

static olx_bc1_block encode_single(const olx_line *l) {
  uint32_t ends[2][CHANNELS];
  for (uint32_t k = 0; k < CHANNELS; k++) {
    uint32_t codes[2] = {0, 0};
    single(l->from[k], k, codes);
    ends[0][k] = codes[0];
    ends[1][k] = codes[1];
  }
  int32_t index[TEXELS];
  for (uint32_t i = 0; i < TEXELS; i++) index[i] = 1;
  return write_block(packed(ends[0]), packed(ends[1]), index);
}

olx_bc1_block olx_bc1_encode(const uint32_t texels[16], uint32_t counted) {
  if (!(counted & 0xFFFFu)) return (olx_bc1_block){{0, 0}};
  olx_line_colours s;
  load(&s, texels, counted);
  olx_line l = olx_line_through(&s, CHANNELS);
  if (l.from[0] == l.to[0] && l.from[1] == l.to[1] && l.from[2] == l.to[2]) return encode_single(&l);
  for (uint32_t round = 0; round < REFINEMENTS; round++) olx_line_refine(&s, STEPS, &l);
  uint32_t ends[2][CHANNELS];
  for (uint32_t k = 0; k < CHANNELS; k++) {
    ends[0][k] = quantize(l.from[k], k);
    ends[1][k] = quantize(l.to[k], k);
    l.from[k] = (float)expand(ends[0][k], k);
    l.to[k] = (float)expand(ends[1][k], k);
  }
  olx_row_words index[OLX_LINE_ROWS];
  olx_row share[OLX_LINE_ROWS];
  int32_t chosen[TEXELS];
  olx_line_choose(&s, &l, STEPS, index, share);
  memcpy(chosen, index, sizeof chosen);
  return write_block(packed(ends[0]), packed(ends[1]), chosen);
}
