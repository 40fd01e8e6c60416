// Encodes BC6H blocks: lines between two colours by weighted least squares on the bits of half floats, which are nearly logarithms,
// in the mode whose numbers hold the line best.
#include "block/bc6h_encode.h"

#include <stdlib.h>

enum { CHANNELS = 3, TEXELS = 16, LANES = 4, GROUPS = TEXELS / LANES, REFINEMENTS = 2, STARTS = 3 };

// Interpolated numbers are 64/31 of the bits of a half float.
static const float BITS_SCALE = 64.0f / 31.0f;
// Light below this share of what errors are relative to may as well have it: zeros would take half of a line's range.
static const float LEAST_SHARE = 1.0f / 128.0f;
// What errors are relative to is at least this share of the brightest light of the block, unless it is given.
static const float DARKNESS = 1.0f / 100.0f;
// A change of a dark channel counts as if it were at least this share.
static const float LEAST_WEIGHT = 1.0f / 32.0f;
// Lines over more than this, 2.5 factors of 2, are also begun from brighter ends.
static const float LONG_LINE = 2.5f * 1024.0f * 64.0f / 31.0f;
// The largest half float.
static const float MOST_LIGHT = 65504.0f;

// A row of a block. Written so that four texels are one instruction on any machine.
typedef float four __attribute__((vector_size(16)));
typedef int32_t four_words __attribute__((vector_size(16)));

typedef struct colours {
  four value[CHANNELS][GROUPS];  // of the light, relative to what errors are relative to
  four unit[GROUPS];             // 1 / what they are relative to
  four place[CHANNELS][GROUPS];  // of the light, as the format interpolates
  four weight[CHANNELS][GROUPS]; // of the square of an error of `place`; 0 for texels that do not count
  four on[GROUPS];               // 1 for texels that count, else 0
} colours;

// The ends of a line, in the numbers that are interpolated.
typedef struct line {
  float from[CHANNELS], to[CHANNELS];
} line;

// A coded line, its texels' indices, and the sum of their squared relative errors.
typedef struct coding {
  uint32_t precision, difference_bits;
  uint32_t from[CHANNELS], to[CHANNELS];
  int32_t index[TEXELS];
  float error;
} coding;

static inline four pick(four_words mask, four a, four b) { return (four)((mask & (four_words)a) | (~mask & (four_words)b)); }
static inline four most(four a, four b) { return pick(a > b, a, b); }
static inline four least(four a, four b) { return pick(a < b, a, b); }
static inline four splat(float f) { return (four){f, f, f, f}; }
static inline four square(four a) { return a * a; }

static inline float sum(const four v[GROUPS]) {
  const four part = (v[0] + v[1]) + (v[2] + v[3]);
  return (part[0] + part[1]) + (part[2] + part[3]);
}

// Bits of half floats, with a fraction, in interpolated numbers; of light from 0 to MOST_LIGHT.
static inline four places_of(four light) {
  const four normal = __builtin_convertvector((four_words)light - 0x38000000, four) * 0x1p-13f;
  return pick(light < 0x1p-14f, light * 0x1p24f, normal) * BITS_SCALE;
}

// The light at places: the inverse, without rounding to a half float.
static inline four light_at(four place) {
  const four bits = place * (1.0f / BITS_SCALE);
  const four normal = (four)(__builtin_convertvector(bits * 0x1p13f, four_words) + 0x38000000);
  return pick(bits < 1024.0f, bits * 0x1p-24f, normal);
}

// From colours to rows of channels, black where a texel does not count.
static void load(const olx_vec3 *texels, const four on[GROUPS], four light[CHANNELS][GROUPS]) {
  for (uint32_t g = 0; g < GROUPS; g++) {
    const olx_vec3 *t = texels + LANES * g;
    const four c[CHANNELS] = {{t[0].x, t[1].x, t[2].x, t[3].x}, {t[0].y, t[1].y, t[2].y, t[3].y},
                              {t[0].z, t[1].z, t[2].z, t[3].z}};
    for (uint32_t k = 0; k < CHANNELS; k++) light[k][g] = on[g] * least(most(c[k], splat(0.0f)), splat(MOST_LIGHT));
  }
}

static float brightest(four light[CHANNELS][GROUPS]) {
  four highest = splat(0.0f);
  for (uint32_t k = 0; k < CHANNELS; k++) {
    for (uint32_t g = 0; g < GROUPS; g++) highest = most(highest, light[k][g]);
  }
  return olx_max(olx_max(highest[0], highest[1]), olx_max(highest[2], highest[3]));
}

static void set_colours(colours *s, const olx_vec3 *texels, const float *relative_to, uint32_t counted) {
  four light[CHANNELS][GROUPS];
  for (uint32_t i = 0; i < TEXELS; i++) s->on[i / LANES][i % LANES] = (float)(counted >> i & 1u);
  load(texels, s->on, light);
  const float floor = olx_max(0x1p-24f, relative_to ? 0.0f : DARKNESS * brightest(light));
  for (uint32_t g = 0; g < GROUPS; g++) {
    const float *given = relative_to + LANES * g;
    const four own = most(light[0][g], most(light[1][g], light[2][g]));
    const four wanted = relative_to ? (four){given[0], given[1], given[2], given[3]} : own;
    const four unit = least(most(most(wanted, own * 0x1p-10f), splat(floor)), splat(0x1p30f));
    s->unit[g] = 1.0f / unit;
    for (uint32_t k = 0; k < CHANNELS; k++) {
      s->value[k][g] = light[k][g] * s->unit[g];
      s->place[k][g] = places_of(least(most(light[k][g], unit * LEAST_SHARE), splat(MOST_LIGHT)));
      s->weight[k][g] = s->on[g] * square(most(s->value[k][g], splat(LEAST_WEIGHT)));
    }
  }
}

static inline float product(const four a[GROUPS], const four b[GROUPS]) {
  four part[GROUPS];
  for (uint32_t g = 0; g < GROUPS; g++) part[g] = a[g] * b[g];
  return sum(part);
}

// The mean place, and the direction in which the places spread most by a few steps of power iteration; false where they do not.
static bool spread(const colours *s, float middle[CHANNELS], float axis[CHANNELS]) {
  float scale[CHANNELS];
  four off[CHANNELS][GROUPS];
  for (uint32_t k = 0; k < CHANNELS; k++) {
    scale[k] = sum(s->weight[k]);
    middle[k] = product(s->weight[k], s->place[k]) / scale[k];
    for (uint32_t g = 0; g < GROUPS; g++) off[k][g] = s->on[g] * (s->place[k][g] - middle[k]);
    axis[k] = 1.0f;
  }
  const float xx = product(off[0], off[0]), xy = product(off[0], off[1]), xz = product(off[0], off[2]),
              yy = product(off[1], off[1]), yz = product(off[1], off[2]), zz = product(off[2], off[2]);
  for (uint32_t round = 0; round < 4; round++) {
    const float x = axis[0] * scale[0], y = axis[1] * scale[1], z = axis[2] * scale[2];
    const float a = xx * x + xy * y + xz * z, b = xy * x + yy * y + yz * z, c = xz * x + yz * y + zz * z;
    const float longest = olx_max(fabsf(a), olx_max(fabsf(b), fabsf(c)));
    if (!(longest > 0.0f)) return false;
    axis[0] = a / longest, axis[1] = b / longest, axis[2] = c / longest;
  }
  return true;
}

// How many times `step` each texel lies beyond `from`, by what suits it best.
static void project(const colours *s, const float from[CHANNELS], const float step[CHANNELS], four share[GROUPS]) {
  for (uint32_t g = 0; g < GROUPS; g++) {
    four along = splat(0.0f), squared = splat(1e-12f);
    for (uint32_t k = 0; k < CHANNELS; k++) {
      const four w = s->weight[k][g] * step[k];
      along += w * (s->place[k][g] - from[k]);
      squared += w * step[k];
    }
    share[g] = along / squared;
  }
}

// The line through all texels.
static line first_line(const colours *s) {
  line l;
  float middle[CHANNELS], axis[CHANNELS];
  if (!spread(s, middle, axis)) {
    memcpy(l.from, middle, sizeof l.from);
    memcpy(l.to, middle, sizeof l.to);
    return l;
  }
  four share[GROUPS], low = splat(INFINITY), high = splat(-INFINITY);
  project(s, middle, axis, share);
  for (uint32_t g = 0; g < GROUPS; g++) {
    low = least(low, pick(s->on[g] > 0.0f, share[g], low));
    high = most(high, pick(s->on[g] > 0.0f, share[g], high));
  }
  const float first = olx_min(olx_min(low[0], low[1]), olx_min(low[2], low[3])),
              last = olx_max(olx_max(high[0], high[1]), olx_max(high[2], high[3]));
  for (uint32_t k = 0; k < CHANNELS; k++) {
    l.from[k] = middle[k] + first * axis[k];
    l.to[k] = middle[k] + last * axis[k];
  }
  return l;
}

// The index of each texel on a line, and the share of `to` that it stands for.
static void choose(const colours *s, const line *l, four_words index[GROUPS], four share[GROUPS]) {
  float step[CHANNELS];
  for (uint32_t k = 0; k < CHANNELS; k++) step[k] = l->to[k] - l->from[k];
  project(s, l->from, step, share);
  for (uint32_t g = 0; g < GROUPS; g++) {
    const four clamped = least(most(share[g], splat(0.0f)), splat(1.0f));
    index[g] = __builtin_convertvector(clamped * 15.0f + 0.5f, four_words);
    const four whole = __builtin_convertvector(index[g], four) * (64.0f / 15.0f) + 0.5f;
    share[g] = __builtin_convertvector(__builtin_convertvector(whole, four_words), four) * (1.0f / 64.0f);
  }
}

// The ends that are best for the indices that the texels take on the line.
static void refine(const colours *s, line *l) {
  four_words index[GROUPS];
  four share[GROUPS], p[5][GROUPS];
  choose(s, l, index, share);
  for (uint32_t k = 0; k < CHANNELS; k++) {
    for (uint32_t g = 0; g < GROUPS; g++) {
      const four wb = s->weight[k][g] * share[g], wa = s->weight[k][g] - wb, x = s->place[k][g] - l->from[k];
      p[0][g] = wa * (1.0f - share[g]);
      p[1][g] = wa * share[g];
      p[2][g] = wb * share[g];
      p[3][g] = wa * x;
      p[4][g] = wb * x;
    }
    const float aa = sum(p[0]), ab = sum(p[1]), bb = sum(p[2]), ax = sum(p[3]), bx = sum(p[4]);
    const float determinant = aa * bb - ab * ab, middle = l->from[k];
    if (!(determinant > 1e-4f * aa * bb)) continue;
    l->from[k] = middle + (ax * bb - bx * ab) / determinant;
    l->to[k] = middle + (bx * aa - ax * ab) / determinant;
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
static bool quantize_line(const line *l, uint32_t precision, uint32_t difference_bits, coding *c) {
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
  line l;
  four share[GROUPS], error[GROUPS];
  four_words index[GROUPS];
  for (uint32_t k = 0; k < CHANNELS; k++) {
    l.from[k] = (float)olx_bc6h_unquantize(c->from[k], c->precision);
    l.to[k] = (float)olx_bc6h_unquantize(c->to[k], c->precision);
  }
  choose(s, &l, index, share);
  for (uint32_t g = 0; g < GROUPS; g++) {
    error[g] = splat(0.0f);
    for (uint32_t k = 0; k < CHANNELS; k++) {
      const four light = light_at(share[g] * (l.to[k] - l.from[k]) + l.from[k]) * s->unit[g];
      error[g] += s->on[g] * square(light - s->value[k][g]);
    }
  }
  c->error = sum(error);
  memcpy(c->index, index, sizeof index);
}

// The modes with one region, the finest first.
static coding code_line(const colours *s, const line *l) {
  static const uint8_t MODES[4][2] = {{16, 4}, {12, 8}, {11, 9}, {10, 10}};
  coding c;
  for (uint32_t i = 0; i < 4; i++) {
    if (quantize_line(l, MODES[i][0], MODES[i][1], &c)) break;
  }
  choose_indices(s, &c);
  return c;
}

// The line from a share of its length on, which leaves its darker end to texels for which a larger share will do.
static line brighter_part(const line *l, float share) {
  const bool rising = l->to[0] + l->to[1] + l->to[2] > l->from[0] + l->from[1] + l->from[2];
  line part = *l;
  for (uint32_t k = 0; k < CHANNELS; k++) {
    const float step = share * (l->to[k] - l->from[k]);
    if (rising) part.from[k] += step;
    else part.to[k] -= step;
  }
  return part;
}

static coding best_line(const colours *s) {
  const line whole = first_line(s);
  float length = 0.0f;
  for (uint32_t k = 0; k < CHANNELS; k++) length = olx_max(length, fabsf(whole.to[k] - whole.from[k]));
  coding best = {.error = INFINITY};
  for (uint32_t start = 0; start < (length > LONG_LINE ? STARTS : 1); start++) {
    line l = brighter_part(&whole, 0.25f * (float)start);
    for (uint32_t round = 0; round < REFINEMENTS; round++) refine(s, &l);
    const coding c = code_line(s, &l);
    if (c.error < best.error || start == 0) best = c;
  }
  return best;
}

typedef struct writer {
  uint64_t low, high;
  uint32_t at;
} writer;

static void put(writer *w, uint32_t value, uint32_t count) {
  if (w->at < 64) w->low |= (uint64_t)value << w->at;
  if (w->at >= 64) w->high |= (uint64_t)value << (w->at - 64);
  else if (w->at + count > 64) w->high |= (uint64_t)value >> (64 - w->at);
  w->at += count;
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
  writer w = {0, 0, 0};
  put(&w, c->precision == 16 ? 15 : c->precision == 12 ? 11 : c->precision == 11 ? 7 : 3, 5);
  for (uint32_t k = 0; k < CHANNELS; k++) put(&w, c->from[k] & 1023u, 10);
  for (uint32_t k = 0; k < CHANNELS; k++) {
    const uint32_t difference = c->precision == 10 ? c->to[k] : c->to[k] - c->from[k];
    put(&w, difference & ((1u << c->difference_bits) - 1), c->difference_bits);
    put(&w, reversed(c->from[k] >> 10, c->precision - 10), c->precision - 10);
  }
  for (uint32_t i = 0; i < TEXELS; i++) put(&w, (uint32_t)c->index[i], i == 0 ? 3 : 4);
  return (olx_bc6h_block){{(uint32_t)w.low, (uint32_t)(w.low >> 32), (uint32_t)w.high, (uint32_t)(w.high >> 32)}};
}

olx_bc6h_block olx_bc6h_encode(const olx_vec3 texels[16], const float relative_to[16], uint32_t counted) {
  if (!(counted & 0xFFFFu)) return (olx_bc6h_block){{3}}; // of one region, since that is decoded fastest
  colours s;
  set_colours(&s, texels, relative_to, counted);
  coding best = best_line(&s);
  return write_block(&best);
}
