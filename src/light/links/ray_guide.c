// Learns from the first rays of neighbouring surfels which directions bring light, and draws further rays from the
// learnt density.
#include "light/links/ray_guide.h"

#include "core/hooks.h"
#include "core/result.h"
#include "core/sampling.h"

// Least density of any direction, as a share of the density without a guide.
static const float LEAST_DENSITY = 0.25f;
// Least ratio of variance that a guide is assumed to reach.
static const float LEAST_SPREAD = 1.0f / 32.0f;

// Returns the cell `levels` above another, or the largest one around it.
static uint64_t cell_above(uint64_t cell, uint32_t levels) {
  while (levels > 0 && olx_cell_at_level(cell, levels) >> OLX_CELL_BIN_BITS == 0) levels--;
  return olx_cell_at_level(cell, levels);
}

olx_result olx_pool_surfels(const olx_light_surfels *surfels, uint32_t levels, uint32_t *pool_of, uint32_t *count) {
  olx_cell_table table = {0};
  olx_result result = olx_cell_table_create(&table, surfels->count);
  *count = 0;
  for (uint32_t i = 0; result == OLX_OK && i < surfels->count; i++) {
    const uint64_t key = cell_above(surfels->surfels[i].cell, levels);
    uint32_t number = olx_cell_table_get(&table, key);
    if (number == OLX_CELL_NONE) {
      number = (*count)++;
      result = olx_cell_table_set(&table, key, number);
    }
    pool_of[i] = number;
  }
  olx_cell_table_free(&table);
  return result;
}

olx_result olx_ray_guide_create(olx_ray_guide *g, const olx_light_surfels *surfels) {
  *g = (olx_ray_guide){.pool_of = olx_allocate(surfels->count, sizeof *g->pool_of)};
  olx_result result = g->pool_of ? OLX_OK : OLX_ERROR_MEMORY;
  if (result == OLX_OK) result = olx_pool_surfels(surfels, OLX_POOL_LEVELS, g->pool_of, &g->pool_count);
  if (result == OLX_OK) g->pools = olx_allocate_zero(g->pool_count, sizeof *g->pools);
  if (result == OLX_OK && g->pools) return OLX_OK;
  olx_ray_guide_free(g);
  return olx_fail(OLX_ERROR_MEMORY, "light: out of memory for guiding the rays of %u surfels", surfels->count);
}

void olx_ray_guide_free(olx_ray_guide *g) {
  olx_release(g->pool_of);
  olx_release(g->pools);
  *g = (olx_ray_guide){0};
}

static uint32_t bin_of(olx_vec2 point) {
  const uint32_t x = (uint32_t)(point.x * OLX_GUIDE_SIDE), y = (uint32_t)(point.y * OLX_GUIDE_SIDE);
  const uint32_t last = OLX_GUIDE_SIDE - 1;
  return (y < last ? y : last) * OLX_GUIDE_SIDE + (x < last ? x : last);
}

void olx_guide_add(olx_guide_sums *sums, olx_vec2 point, float light) {
  const uint32_t bin = bin_of(point);
  sums->light += (double)light;
  sums->squares[bin] += (double)light * (double)light;
  sums->counts[bin]++;
  sums->count++;
}

// Computes the mean squares of the bins; a bin without a ray gets the mean of all.
static void mean_squares(const olx_guide_sums *sums, float squares[OLX_GUIDE_BINS]) {
  double all = 0.0;
  for (uint32_t i = 0; i < OLX_GUIDE_BINS; i++) all += sums->squares[i];
  for (uint32_t i = 0; i < OLX_GUIDE_BINS; i++) {
    squares[i] = (float)(sums->counts[i] ? sums->squares[i] / sums->counts[i] : all / sums->count);
  }
}

// Returns half of a bin's own root mean square plus half of its neighbours' mean, because neighbouring surfels see the
// same source in slightly different directions.
static float blurred_root(const float squares[OLX_GUIDE_BINS], uint32_t bin) {
  float sum = 0.0f, count = 0.0f;
  for (uint32_t k = 0; k < 9; k++) {
    const uint32_t x = bin % OLX_GUIDE_SIDE + k % 3 - 1,
                   y = bin / OLX_GUIDE_SIDE + k / 3 - 1; // outside the square when negative
    if (k == 4 || x >= OLX_GUIDE_SIDE || y >= OLX_GUIDE_SIDE) continue;
    sum += sqrtf(squares[y * OLX_GUIDE_SIDE + x]);
    count += 1.0f;
  }
  return 0.5f * sqrtf(squares[bin]) + 0.5f * sum / count;
}

// Returns the ratio by which the density reduces the variance of a ray, if each bin continues to bring what it brought.
static float spread_of(const olx_ray_pool *pool, const float squares[OLX_GUIDE_BINS], float mean) {
  float even = 0.0f, guided = 0.0f;
  for (uint32_t i = 0; i < OLX_GUIDE_BINS; i++) {
    even += squares[i] / OLX_GUIDE_BINS;
    guided += squares[i] / pool->density[i] / OLX_GUIDE_BINS;
  }
  if (even <= mean * mean) return 1.0f;
  return olx_clamp((guided - mean * mean) / (even - mean * mean), LEAST_SPREAD, 1.0f);
}

// Rounds to a power of the square root of two. A learnt number then stays the same when the light changes slightly, and
// so do the rays that are drawn by it: they need not be cast again after an edit of the scene.
static float coarse(float x) { return exp2f(0.5f * roundf(2.0f * log2f(x))); }

void olx_guide_learn(olx_ray_pool *pool, const olx_guide_sums *sums) {
  for (uint32_t i = 0; i < OLX_GUIDE_BINS; i++) pool->density[i] = 1.0f;
  pool->spread = 1.0f;
  if (sums->light <= 0.0) return;
  float squares[OLX_GUIDE_BINS], total = 0.0f;
  mean_squares(sums, squares);
  for (uint32_t i = 0; i < OLX_GUIDE_BINS; i++) {
    pool->density[i] = blurred_root(squares, i);
    total += pool->density[i];
  }
  const float scale = (1.0f - LEAST_DENSITY) * OLX_GUIDE_BINS / total;
  float sum = 0.0f;
  for (uint32_t i = 0; i < OLX_GUIDE_BINS; i++) {
    pool->density[i] = coarse(LEAST_DENSITY + scale * pool->density[i]);
    sum += pool->density[i];
  }
  for (uint32_t i = 0; i < OLX_GUIDE_BINS; i++) pool->density[i] *= OLX_GUIDE_BINS / sum;
  pool->spread = olx_min(coarse(spread_of(pool, squares, (float)(sums->light / sums->count))), 1.0f);
}

// Returns the bin that has the fewest rays for its density among those whose rays can be doubled with `left` more.
static uint32_t find_poorest(const olx_ray_pool *pool, const uint16_t bins[OLX_GUIDE_BINS], uint32_t left) {
  uint32_t found = OLX_GUIDE_BINS;
  float most = 0.0f;
  for (uint32_t i = 0; i < OLX_GUIDE_BINS; i++) {
    const float ratio = (pool ? pool->density[i] : 1.0f) / (float)bins[i];
    if (bins[i] > left || ratio <= most) continue;
    most = ratio;
    found = i;
  }
  return found;
}

void olx_guide_divide(const olx_ray_pool *pool, uint32_t rays, uint16_t bins[OLX_GUIDE_BINS]) {
  for (uint32_t i = 0; i < OLX_GUIDE_BINS; i++) bins[i] = 1;
  for (uint32_t left = rays - OLX_GUIDE_BINS; left > 0;) {
    const uint32_t bin = find_poorest(pool, bins, left);
    left -= bins[bin];
    bins[bin] *= 2;
  }
}

// ---- A sequence by bins

enum { DIGITS = 3, DIGIT_MASK = OLX_GUIDE_SIDE - 1, BLOCK_BITS = 2 * DIGITS };

// Coordinates with reversed bits: their first digits are the low bits, and depend on low bits alone.
static uint32_t x_of(const olx_bin_sequence *s, uint32_t index) {
  return olx_owen_scramble_reversed(index, olx_hash(s->seed + 1u));
}

static uint32_t y_of(const olx_bin_sequence *s, uint32_t sobol) {
  return olx_owen_scramble_reversed(sobol, olx_hash(s->seed + 2u));
}

olx_bin_sequence olx_bin_sequence_make(uint32_t seed) {
  olx_bin_sequence s = {.seed = seed};
  for (uint32_t digits = 0; digits < OLX_GUIDE_SIDE; digits++) {
    s.x[olx_reverse_bits(x_of(&s, digits)) >> (32 - DIGITS)] = (uint8_t)digits;
    s.y[olx_reverse_bits(y_of(&s, digits)) >> (32 - DIGITS)] = (uint8_t)digits;
  }
  return s;
}

// The column fixes the three low bits of the index, and the row three bits of Sobol's second dimension, which are sums
// of index bits (olx_sobol2_reversed): bit 3 is in all of them, bit 5 in the two lowest, bit 4 in the lowest.
uint32_t olx_bin_sequence_index(const olx_bin_sequence *s, uint32_t bin, uint32_t number) {
  const uint32_t index = number << BLOCK_BITS | s->x[bin % OLX_GUIDE_SIDE];
  const uint32_t missing = (olx_sobol2_reversed(index) & DIGIT_MASK) ^ s->y[bin / OLX_GUIDE_SIDE];
  const uint32_t bit3 = missing >> 2 & 1u, bit5 = (missing >> 1 & 1u) ^ bit3, bit4 = (missing & 1u) ^ bit3 ^ bit5;
  return index | bit3 << 3 | bit4 << 4 | bit5 << 5;
}

olx_vec2 olx_bin_sequence_point(const olx_bin_sequence *s, uint32_t index) {
  return (olx_vec2){olx_unit_float(olx_reverse_bits(x_of(s, index))),
                    olx_unit_float(olx_reverse_bits(y_of(s, olx_sobol2_reversed(index))))};
}
