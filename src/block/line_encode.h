// Fits a line to 16 colours, for the encoders of texture blocks. Each texel's colour becomes a step of the line, so
// only its ends and the steps are stored.
#ifndef OLX_BLOCK_LINE_ENCODE_H
#define OLX_BLOCK_LINE_ENCODE_H

#include "core/vec.h"

#include <string.h>

enum { OLX_LINE_LANES = 4, OLX_LINE_ROWS = 4, OLX_LINE_CHANNELS = 4 };

// A row of a block: four texels in one vector of any machine.
typedef float olx_row __attribute__((vector_size(16)));
typedef int32_t olx_row_words __attribute__((vector_size(16)));

// Colours in the numbers that the format interpolates, with as many channels as a function is called for.
typedef struct olx_line_colours {
  olx_row place[OLX_LINE_CHANNELS][OLX_LINE_ROWS];
  olx_row weight[OLX_LINE_CHANNELS][OLX_LINE_ROWS]; // of a squared error; 0 for texels that do not count
  olx_row on[OLX_LINE_ROWS];                        // 1 for texels that count, else 0
} olx_line_colours;

typedef struct olx_line {
  float from[OLX_LINE_CHANNELS], to[OLX_LINE_CHANNELS];
} olx_line;

// How a format divides a line: the number of steps, whose shares are rounded to multiples of 1 / `parts`.
typedef struct olx_line_steps {
  uint32_t channels;
  float steps, parts;
} olx_line_steps;

static inline olx_row olx_row_pick(olx_row_words mask, olx_row a, olx_row b) {
  return (olx_row)((mask & (olx_row_words)a) | (~mask & (olx_row_words)b));
}
// Returns the larger numbers; the second where one is NaN.
static inline olx_row olx_row_most(olx_row a, olx_row b) { return olx_row_pick(a > b, a, b); }
static inline olx_row olx_row_least(olx_row a, olx_row b) { return olx_row_pick(a < b, a, b); }
static inline olx_row olx_row_splat(float f) { return (olx_row){f, f, f, f}; }
static inline float olx_row_highest(olx_row a) { return olx_max(olx_max(a[0], a[1]), olx_max(a[2], a[3])); }

static inline float olx_line_sum(const olx_row v[OLX_LINE_ROWS]) {
  const olx_row part = (v[0] + v[1]) + (v[2] + v[3]);
  return (part[0] + part[1]) + (part[2] + part[3]);
}

static inline float olx_line_product(const olx_row a[OLX_LINE_ROWS], const olx_row b[OLX_LINE_ROWS]) {
  olx_row part[OLX_LINE_ROWS];
  for (uint32_t g = 0; g < OLX_LINE_ROWS; g++) part[g] = a[g] * b[g];
  return olx_line_sum(part);
}

// Computes the mean place, and the direction in which places spread most, by a few steps of power iteration; false
// where they do not spread.
static inline bool olx_line_spread(const olx_line_colours *s, uint32_t channels, float middle[OLX_LINE_CHANNELS],
                                   float axis[OLX_LINE_CHANNELS]) {
  float scale[OLX_LINE_CHANNELS], covariance[OLX_LINE_CHANNELS][OLX_LINE_CHANNELS];
  olx_row off[OLX_LINE_CHANNELS][OLX_LINE_ROWS];
  for (uint32_t k = 0; k < channels; k++) {
    scale[k] = olx_line_sum(s->weight[k]);
    middle[k] = olx_line_product(s->weight[k], s->place[k]) / scale[k];
    for (uint32_t g = 0; g < OLX_LINE_ROWS; g++) off[k][g] = s->on[g] * (s->place[k][g] - middle[k]);
    for (uint32_t j = 0; j <= k; j++) covariance[j][k] = covariance[k][j] = olx_line_product(off[j], off[k]);
  }
  uint32_t widest = 0;
  for (uint32_t k = 1; k < channels; k++) {
    if (covariance[k][k] * scale[k] > covariance[widest][widest] * scale[widest]) widest = k;
  }
  if (!(covariance[widest][widest] > 0.0f)) return false;
  for (uint32_t k = 0; k < channels; k++) axis[k] = covariance[widest][k] / covariance[widest][widest];
  for (uint32_t round = 0; round < 3; round++) {
    float next[OLX_LINE_CHANNELS] = {0.0f}, longest = 0.0f;
    for (uint32_t k = 0; k < channels; k++) {
      for (uint32_t j = 0; j < channels; j++) next[k] += covariance[k][j] * axis[j] * scale[j];
      longest = olx_max(longest, fabsf(next[k]));
    }
    for (uint32_t k = 0; k < channels; k++) axis[k] = next[k] / longest;
  }
  return true;
}

// Computes each texel's best position on a line, as a multiple of `step` from `from`.
static inline void olx_line_project(const olx_line_colours *s, uint32_t channels, const float from[OLX_LINE_CHANNELS],
                                    const float step[OLX_LINE_CHANNELS], olx_row share[OLX_LINE_ROWS]) {
  for (uint32_t g = 0; g < OLX_LINE_ROWS; g++) {
    olx_row along = olx_row_splat(0.0f), squared = olx_row_splat(1e-12f);
    for (uint32_t k = 0; k < channels; k++) {
      const olx_row w = s->weight[k][g] * step[k];
      along += w * (s->place[k][g] - from[k]);
      squared += w * step[k];
    }
    share[g] = along / squared;
  }
}

// Returns the line through all texels, from end to end.
static inline olx_line olx_line_through(const olx_line_colours *s, uint32_t channels) {
  olx_line l = {.from = {0.0f}};
  float axis[OLX_LINE_CHANNELS];
  if (!olx_line_spread(s, channels, l.from, axis)) {
    memcpy(l.to, l.from, sizeof l.to);
    return l;
  }
  olx_row share[OLX_LINE_ROWS], low = olx_row_splat(INFINITY), high = olx_row_splat(-INFINITY);
  olx_line_project(s, channels, l.from, axis, share);
  for (uint32_t g = 0; g < OLX_LINE_ROWS; g++) {
    low = olx_row_least(low, olx_row_pick(s->on[g] > 0.0f, share[g], low));
    high = olx_row_most(high, olx_row_pick(s->on[g] > 0.0f, share[g], high));
  }
  const float first = -olx_row_highest(-low), last = olx_row_highest(high);
  for (uint32_t k = 0; k < channels; k++) {
    const float middle = l.from[k];
    l.from[k] = middle + first * axis[k];
    l.to[k] = middle + last * axis[k];
  }
  return l;
}

// Chooses the step of each texel on a line, and the share of `to` to which that step corresponds.
static inline void olx_line_choose(const olx_line_colours *s, const olx_line *l, olx_line_steps steps,
                                   olx_row_words index[OLX_LINE_ROWS], olx_row share[OLX_LINE_ROWS]) {
  float step[OLX_LINE_CHANNELS];
  for (uint32_t k = 0; k < steps.channels; k++) step[k] = l->to[k] - l->from[k];
  olx_line_project(s, steps.channels, l->from, step, share);
  for (uint32_t g = 0; g < OLX_LINE_ROWS; g++) {
    const olx_row clamped = olx_row_least(olx_row_most(share[g], olx_row_splat(0.0f)), olx_row_splat(1.0f));
    index[g] = __builtin_convertvector(clamped * steps.steps + 0.5f, olx_row_words);
    const olx_row part = __builtin_convertvector(index[g], olx_row) * (steps.parts / steps.steps) + 0.5f;
    share[g] = __builtin_convertvector(__builtin_convertvector(part, olx_row_words), olx_row) * (1.0f / steps.parts);
  }
}

// Moves the ends to where they are best for the texels' steps.
static inline void olx_line_refine(const olx_line_colours *s, olx_line_steps steps, olx_line *l) {
  olx_row_words index[OLX_LINE_ROWS];
  olx_row share[OLX_LINE_ROWS], p[5][OLX_LINE_ROWS];
  olx_line_choose(s, l, steps, index, share);
  for (uint32_t k = 0; k < steps.channels; k++) {
    for (uint32_t g = 0; g < OLX_LINE_ROWS; g++) {
      const olx_row wb = s->weight[k][g] * share[g], wa = s->weight[k][g] - wb, x = s->place[k][g] - l->from[k];
      p[0][g] = wa * (1.0f - share[g]);
      p[1][g] = wa * share[g];
      p[2][g] = wb * share[g];
      p[3][g] = wa * x;
      p[4][g] = wb * x;
    }
    const float aa = olx_line_sum(p[0]), ab = olx_line_sum(p[1]), bb = olx_line_sum(p[2]), ax = olx_line_sum(p[3]),
                bx = olx_line_sum(p[4]);
    const float determinant = aa * bb - ab * ab, middle = l->from[k];
    if (!(determinant > 1e-4f * aa * bb)) continue;
    l->from[k] = middle + (ax * bb - bx * ab) / determinant;
    l->to[k] = middle + (bx * aa - ax * ab) / determinant;
  }
}

// The bits of a block, the first bit lowest.
typedef struct olx_block_writer {
  uint64_t low, high;
  uint32_t at;
} olx_block_writer;

static inline void olx_block_put(olx_block_writer *w, uint32_t value, uint32_t count) {
  if (w->at < 64) w->low |= (uint64_t)value << w->at;
  if (w->at >= 64) w->high |= (uint64_t)value << (w->at - 64);
  else if (w->at + count > 64) w->high |= (uint64_t)value >> (64 - w->at);
  w->at += count;
}

static inline void olx_block_store(const olx_block_writer *w, uint32_t words[4]) {
  words[0] = (uint32_t)w->low;
  words[1] = (uint32_t)(w->low >> 32);
  words[2] = (uint32_t)w->high;
  words[3] = (uint32_t)(w->high >> 32);
}

#endif
