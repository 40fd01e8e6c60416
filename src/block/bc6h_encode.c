// Encodes BC6H blocks: lines between two colours by weighted least squares on the bits of half floats, which are nearly logarithms,
// in the mode whose numbers hold the line best.
#include "block/bc6h_encode.h"

#include "block/line_encode.h"

#include <stdlib.h>

enum { CHANNELS = 3, TEXELS = 16, GROUPS = OLX_LINE_ROWS, LANES = OLX_LINE_LANES, REFINEMENTS = 2, STARTS = 3 };

// Interpolated numbers are 64/31 of the bits of a half float.
static const float BITS_SCALE = 64.0f / 31.0f;
// Light below this share of what errors are relative to may as well have it, where the channel is as bright elsewhere in the block:
// zeros would take half of a line's range.
static const float LEAST_SHARE = 1.0f / 128.0f;
// What errors are relative to is at least this share of the brightest light of the block, unless it is given.
static const float DARKNESS = 1.0f / 100.0f;
// A change of a dark channel counts as if it were at least this share.
static const float LEAST_WEIGHT = 1.0f / 32.0f;
// Lines over more than this, 2.5 factors of 2, are also begun from brighter ends.
static const float LONG_LINE = 2.5f * 1024.0f * 64.0f / 31.0f;
static const olx_line_steps STEPS = {CHANNELS, 15.0f, 64.0f};
// The largest half float.
static const float MOST_LIGHT = 65504.0f;

// Places are interpolated numbers; values are light relative to what errors are relative to, and unit is 1 / that.
typedef struct colours {
  olx_line_colours line;
  olx_row value[CHANNELS][GROUPS], unit[GROUPS];
} colours;

// A coded line, its texels' indices, and the sum of their squared relative errors.
typedef struct coding {
  uint32_t precision, difference_bits;
  uint32_t from[CHANNELS], to[CHANNELS];
  int32_t index[TEXELS];
  float error;
} coding;

static inline olx_row square(olx_row a) { return a * a; }

// Bits of half floats, with a fraction, in interpolated numbers; of light from 0 to MOST_LIGHT. Decoding drops fractions, so a
// half more is rounding.
static inline olx_row places_of(olx_row light) {
  const olx_row normal = __builtin_convertvector((olx_row_words)light - 0x38000000, olx_row) * 0x1p-13f;
  return (olx_row_pick(light < 0x1p-14f, light * 0x1p24f, normal) + 0.5f) * BITS_SCALE;
}

// The light at places on average: the inverse, without rounding to a half float.
static inline olx_row light_at(olx_row place) {
  const olx_row bits = olx_row_most(place * (1.0f / BITS_SCALE) - 0.5f, olx_row_splat(0.0f));
  const olx_row normal = (olx_row)(__builtin_convertvector(bits * 0x1p13f, olx_row_words) + 0x38000000);
  return olx_row_pick(bits < 1024.0f, bits * 0x1p-24f, normal);
}

// From colours to rows of channels, black where a texel does not count.
static void load(const olx_vec3 *texels, const olx_row on[GROUPS], olx_row light[CHANNELS][GROUPS]) {
  for (uint32_t g = 0; g < GROUPS; g++) {
    const olx_vec3 *t = texels + LANES * g;
    const olx_row c[CHANNELS] = {{t[0].x, t[1].x, t[2].x, t[3].x}, {t[0].y, t[1].y, t[2].y, t[3].y},
                              {t[0].z, t[1].z, t[2].z, t[3].z}};
    for (uint32_t k = 0; k < CHANNELS; k++) light[k][g] = on[g] * olx_row_least(olx_row_most(c[k], olx_row_splat(0.0f)), olx_row_splat(MOST_LIGHT));
  }
}

static float brightest(const olx_row channel[GROUPS]) {
  olx_row highest = channel[0];
  for (uint32_t g = 1; g < GROUPS; g++) highest = olx_row_most(highest, channel[g]);
  return olx_row_highest(highest);
}

// What the errors of a row are relative to.
static olx_row unit_of(const olx_row own, const float *given, float least) {
  const olx_row wanted = given ? olx_row_most((olx_row){given[0], given[1], given[2], given[3]}, own * 0x1p-10f) : own;
  return olx_row_least(olx_row_most(wanted, olx_row_splat(least)), olx_row_splat(0x1p30f));
}

static void set_colours(colours *s, const olx_vec3 *texels, const float *relative_to, uint32_t counted) {
  olx_row light[CHANNELS][GROUPS];
  for (uint32_t i = 0; i < TEXELS; i++) s->line.on[i / LANES][i % LANES] = (float)(counted >> i & 1u);
  load(texels, s->line.on, light);
  const float most[CHANNELS] = {brightest(light[0]), brightest(light[1]), brightest(light[2])};
  const float least = relative_to ? 0.0f : DARKNESS * olx_max(most[0], olx_max(most[1], most[2]));
  for (uint32_t g = 0; g < GROUPS; g++) {
    const olx_row own = olx_row_most(light[0][g], olx_row_most(light[1][g], light[2][g]));
    const olx_row unit = unit_of(own, relative_to ? relative_to + LANES * g : NULL, olx_max(least, 0x1p-24f));
    s->unit[g] = 1.0f / unit;
    for (uint32_t k = 0; k < CHANNELS; k++) {
      const olx_row floor = olx_row_least(unit * LEAST_SHARE, olx_row_splat(most[k]));
      s->value[k][g] = light[k][g] * s->unit[g];
      s->line.place[k][g] = places_of(olx_row_most(light[k][g], floor));
      s->line.weight[k][g] = s->line.on[g] * square(olx_row_most(s->value[k][g], olx_row_splat(LEAST_WEIGHT)));
    }
  }
}

// The code of so many bits that unquantises nearest.
static uint32_t quantize(float place, uint32_t bits) {
  const float clamped = olx_clamp(place, 0.0f, 65535.0f);
  const uint32_t code = bits >= 16 ? (uint32_t)(clamped + 0.5f) : (uint32_t)(clamped * olx_bits_float((111u + bits) << 23));
  const uint32_t most = bits >= 16 ? 0xFFFFu : (1u << bits) - 1;
  return code > most ? most : code;
}

// Whether a mode's differences reach from one end to the other, whichever comes first.
static bool quantize_line(const olx_line *l, uint32_t precision, uint32_t difference_bits, coding *c) {
  const int32_t most = (1 << (difference_bits - 1)) - 1;
  c->precision = precision;
  c->difference_bits = difference_bits;
  bool reaches = true;
  for (uint32_t k = 0; k < CHANNELS; k++) {
    c->from[k] = quantize(l->from[k], precision);
    c->to[k] = quantize(l->to[k], precision);
    reaches &= abs((int32_t)c->to[k] - (int32_t)c->from[k]) <= most;
  }
  return reaches || precision == 10;
}

// Chooses indices for what the codes decode to, and sums the errors.
static void choose_indices(const colours *s, coding *c) {
  olx_line l;
  olx_row share[GROUPS], error[GROUPS];
  olx_row_words index[GROUPS];
  for (uint32_t k = 0; k < CHANNELS; k++) {
    l.from[k] = (float)olx_bc6h_unquantize(c->from[k], c->precision);
    l.to[k] = (float)olx_bc6h_unquantize(c->to[k], c->precision);
  }
  olx_line_choose(&s->line, &l, STEPS, index, share);
  for (uint32_t g = 0; g < GROUPS; g++) {
    error[g] = olx_row_splat(0.0f);
    for (uint32_t k = 0; k < CHANNELS; k++) {
      const olx_row light = light_at(share[g] * (l.to[k] - l.from[k]) + l.from[k]) * s->unit[g];
      error[g] += s->line.on[g] * square(light - s->value[k][g]);
    }
  }
  c->error = olx_line_sum(error);
  memcpy(c->index, index, sizeof index);
}

// The modes with one region, the finest first.
static coding code_line(const colours *s, const olx_line *l) {
  static const uint8_t MODES[4][2] = {{16, 4}, {12, 8}, {11, 9}, {10, 10}};
  coding c;
  for (uint32_t i = 0; i < 4; i++) {
    if (quantize_line(l, MODES[i][0], MODES[i][1], &c)) break;
  }
  choose_indices(s, &c);
  return c;
}

// The line from a share of its length on, which leaves its darker end to texels for which a larger share will do.
static olx_line brighter_part(const olx_line *l, float share) {
  const bool rising = l->to[0] + l->to[1] + l->to[2] > l->from[0] + l->from[1] + l->from[2];
  olx_line part = *l;
  for (uint32_t k = 0; k < CHANNELS; k++) {
    const float step = share * (l->to[k] - l->from[k]);
    if (rising) part.from[k] += step;
    else part.to[k] -= step;
  }
  return part;
}

static coding best_line(const colours *s) {
  const olx_line whole = olx_line_through(&s->line, CHANNELS);
  float length = 0.0f;
  for (uint32_t k = 0; k < CHANNELS; k++) length = olx_max(length, fabsf(whole.to[k] - whole.from[k]));
  coding best = {.error = INFINITY};
  for (uint32_t start = 0; start < (length > LONG_LINE ? STARTS : 1); start++) {
    olx_line l = brighter_part(&whole, 0.25f * (float)start);
    for (uint32_t round = 0; round < REFINEMENTS; round++) olx_line_refine(&s->line, STEPS, &l);
    const coding c = code_line(s, &l);
    if (c.error < best.error || start == 0) best = c;
  }
  return best;
}

static uint32_t reversed(uint32_t value, uint32_t count) {
  uint32_t result = 0;
  for (uint32_t i = 0; i < count; i++) result |= (value >> i & 1u) << (count - 1 - i);
  return result;
}

// The first texel's index has one bit less: where its highest one is set, the ends change places.
static void turn(coding *c) {
  if (c->index[0] < 8) return;
  for (uint32_t k = 0; k < CHANNELS; k++) {
    const uint32_t from = c->from[k];
    c->from[k] = c->to[k];
    c->to[k] = from;
  }
  for (uint32_t i = 0; i < TEXELS; i++) c->index[i] = 15 - c->index[i];
}

static olx_bc6h_block write_block(coding *c) {
  turn(c);
  olx_block_writer w = {0, 0, 0};
  olx_block_put(&w, c->precision == 16 ? 15 : c->precision == 12 ? 11 : c->precision == 11 ? 7 : 3, 5);
  for (uint32_t k = 0; k < CHANNELS; k++) olx_block_put(&w, c->from[k] & 1023u, 10);
  for (uint32_t k = 0; k < CHANNELS; k++) {
    const uint32_t difference = c->precision == 10 ? c->to[k] : c->to[k] - c->from[k];
    olx_block_put(&w, difference & ((1u << c->difference_bits) - 1), c->difference_bits);
    olx_block_put(&w, reversed(c->from[k] >> 10, c->precision - 10), c->precision - 10);
  }
  for (uint32_t i = 0; i < TEXELS; i++) olx_block_put(&w, (uint32_t)c->index[i], i == 0 ? 3 : 4);
  olx_bc6h_block block;
  olx_block_store(&w, block.words);
  return block;
}

olx_bc6h_block olx_bc6h_encode(const olx_vec3 texels[16], const float relative_to[16], uint32_t counted) {
  if (!(counted & 0xFFFFu)) return (olx_bc6h_block){{3}}; // of one region, since that is decoded fastest
  colours s;
  set_colours(&s, texels, relative_to, counted);
  coding best = best_line(&s);
  return write_block(&best);
}
