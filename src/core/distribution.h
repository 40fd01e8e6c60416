// Draws from a discrete distribution by inverting its cumulative sums, which preserves stratification.
#ifndef OLX_CORE_DISTRIBUTION_H
#define OLX_CORE_DISTRIBUTION_H

#include "core/vec.h"

// Converts `count` weights (not negative) to count + 1 rising sums from 0 to 1. Returns false when all weights are 0.
// The weights may be the first `count` elements of `sums`.
static inline bool olx_distribution_build(const float *weights, uint32_t count, float *sums) {
  double total = 0.0, running = 0.0;
  for (uint32_t i = 0; i < count; i++) total += (double)weights[i];
  if (!(total > 0.0)) return false;
  for (uint32_t i = 0; i < count; i++) {
    const double weight = (double)weights[i];
    sums[i] = (float)(running / total);
    running += weight;
  }
  sums[count] = 1.0f;
  return true;
}

// Returns the probability of element i: exactly the share of numbers in [0, 1) that draw it.
static inline float olx_distribution_probability(const float *sums, uint32_t i) { return sums[i + 1] - sums[i]; }

// Returns the element drawn by a number in [0, 1), never one of probability 0. *rest (may be NULL) receives a number in
// [0, 1) for further draws.
static inline uint32_t olx_distribution_draw(const float *sums, uint32_t count, float random, float *rest) {
  uint32_t low = 0, high = count;
  while (high - low > 1) {
    const uint32_t middle = low + (high - low) / 2;
    if (sums[middle] <= random) {
      low = middle;
    } else {
      high = middle;
    }
  }
  if (rest) {
    const float width = olx_distribution_probability(sums, low);
    *rest = width > 0.0f ? olx_clamp((random - sums[low]) / width, 0.0f, 0x1.fffffep-1f) : 0.0f;
  }
  return low;
}

#endif
