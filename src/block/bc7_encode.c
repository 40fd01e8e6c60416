// Encodes mode 6 of BC7: the line through the texels' colours by least squares, with each value of the two bits that the channels
// of an end share.
#include "block/bc7_encode.h"

#include "block/line_encode.h"

enum { CHANNELS = 4, TEXELS = 16, REFINEMENTS = 2 };

static const olx_line_steps STEPS = {CHANNELS, 15.0f, 64.0f};

// Ends in seven bits a channel, and the bit below those.
typedef struct coding {
  uint32_t ends[2][CHANNELS], shared[2];
  int32_t index[TEXELS];
  float error;
} coding;

static void load(olx_line_colours *s, const uint32_t *texels, const float *weights, uint32_t counted) {
  for (uint32_t i = 0; i < TEXELS; i++) {
    const float on = (float)(counted >> i & 1u);
    s->on[i / 4][i % 4] = on;
    for (uint32_t k = 0; k < CHANNELS; k++) {
      s->place[k][i / 4][i % 4] = on * (float)(texels[i] >> 8 * k & 255u);
      s->weight[k][i / 4][i % 4] = on * weights[k];
    }
  }
}

// The ends' seven bits that suit a shared bit.
static void quantize(const float end[CHANNELS], uint32_t shared, uint32_t codes[CHANNELS]) {
  for (uint32_t k = 0; k < CHANNELS; k++) {
    codes[k] = (uint32_t)(olx_clamp((end[k] - (float)shared) * 0.5f, 0.0f, 127.0f) + 0.5f);
  }
}

static void choose_indices(const olx_line_colours *s, coding *c) {
  olx_line l;
  olx_row_words index[OLX_LINE_ROWS];
  olx_row share[OLX_LINE_ROWS], error[OLX_LINE_ROWS];
  for (uint32_t k = 0; k < CHANNELS; k++) {
    l.from[k] = (float)(c->ends[0][k] << 1 | c->shared[0]);
    l.to[k] = (float)(c->ends[1][k] << 1 | c->shared[1]);
  }
  olx_line_choose(s, &l, STEPS, index, share);
  for (uint32_t g = 0; g < OLX_LINE_ROWS; g++) {
    error[g] = olx_row_splat(0.0f);
    for (uint32_t k = 0; k < CHANNELS; k++) {
      const olx_row off = share[g] * (l.to[k] - l.from[k]) + l.from[k] - s->place[k][g];
      error[g] += s->weight[k][g] * off * off;
    }
  }
  c->error = olx_line_sum(error);
  memcpy(c->index, index, sizeof index);
}

static coding best_coding(const olx_line_colours *s, const olx_line *l) {
  coding best = {.error = INFINITY};
  for (uint32_t bits = 0; bits < 4; bits++) {
    coding c = {.shared = {bits & 1u, bits >> 1}};
    quantize(l->from, c.shared[0], c.ends[0]);
    quantize(l->to, c.shared[1], c.ends[1]);
    choose_indices(s, &c);
    if (c.error < best.error || bits == 0) best = c;
  }
  return best;
}

// The first texel's index has one bit less: where its highest one is set, the ends change places.
static olx_bc7_block write_block(const coding *c) {
  const uint32_t turned = c->index[0] >= 8;
  olx_block_writer w = {0, 0, 0};
  olx_block_put(&w, 64, 7);
  for (uint32_t k = 0; k < CHANNELS; k++) {
    olx_block_put(&w, c->ends[turned][k], 7);
    olx_block_put(&w, c->ends[1 - turned][k], 7);
  }
  olx_block_put(&w, c->shared[turned], 1);
  olx_block_put(&w, c->shared[1 - turned], 1);
  for (uint32_t i = 0; i < TEXELS; i++) {
    olx_block_put(&w, (uint32_t)(turned ? 15 - c->index[i] : c->index[i]), i == 0 ? 3 : 4);
  }
  olx_bc7_block block;
  olx_block_store(&w, block.words);
  return block;
}

olx_bc7_block olx_bc7_encode(const uint32_t texels[16], const float weights[4], uint32_t counted) {
  if (!(counted & 0xFFFFu)) return (olx_bc7_block){{64}};
  olx_line_colours s;
  load(&s, texels, weights, counted);
  olx_line l = olx_line_through(&s, CHANNELS);
  for (uint32_t round = 0; round < REFINEMENTS; round++) olx_line_refine(&s, STEPS, &l);
  const coding best = best_coding(&s, &l);
  return write_block(&best);
}
