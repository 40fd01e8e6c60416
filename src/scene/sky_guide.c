// Learns where the sky is seen from neighbouring pixels, and draws random numbers for its directions accordingly.
#include "scene/sky_guide.h"

#include "core/distribution.h"

// Share of samples that stay even over the square, so that light from where none was found yet is found.
#define EVEN_SHARE 0.1f

void olx_sky_guide_begin(olx_sky_guide *guide) {
  guide->stage = guide->found = 0;
  for (uint32_t i = 0; i < OLX_SKY_BINS; i++) guide->light[i] = 0.0f;
}

void olx_sky_guide_fade(olx_sky_guide *guide, uint32_t found) {
  if (guide->found <= found) return;
  const float share = (float)found / (float)guide->found;
  for (uint32_t i = 0; i < OLX_SKY_BINS; i++) guide->light[i] *= share;
  guide->found = found;
}

static uint32_t bin_of(olx_vec2 point) {
  const uint32_t x = (uint32_t)olx_clamp(point.x * OLX_SKY_ACROSS, 0.0f, OLX_SKY_ACROSS - 1.0f);
  const uint32_t y = (uint32_t)olx_clamp(point.y * OLX_SKY_DOWN, 0.0f, OLX_SKY_DOWN - 1.0f);
  return y * OLX_SKY_ACROSS + x;
}

void olx_sky_guide_add(olx_sky_guide *guide, olx_vec2 point, float luminance) {
  if (!(luminance > 0.0f) || !isfinite(luminance)) return;
  guide->light[bin_of(point)] += luminance;
  guide->found++;
}

// Returns the light of a bin and, with less weight, of those around it, where the window may reach, too.
static float smoothed(const olx_sky_guide *guide, int32_t x, int32_t y) {
  static const float tent[3] = {0.15f, 0.7f, 0.15f};
  float sum = 0.0f;
  for (int32_t j = -1; j <= 1; j++) {
    const int32_t row = y + j < 0 ? 0 : y + j >= OLX_SKY_DOWN ? OLX_SKY_DOWN - 1 : y + j;
    for (int32_t i = -1; i <= 1; i++) {
      const int32_t column = (x + i + OLX_SKY_ACROSS) % OLX_SKY_ACROSS;
      sum += tent[i + 1] * tent[j + 1] * guide->light[row * OLX_SKY_ACROSS + column];
    }
  }
  return sum;
}

static void learn(olx_sky_guide *guide) {
  float weights[OLX_SKY_DOWN][OLX_SKY_ACROSS], rows[OLX_SKY_DOWN], total = 0.0f;
  for (int32_t y = 0; y < OLX_SKY_DOWN; y++) {
    for (int32_t x = 0; x < OLX_SKY_ACROSS; x++) total += weights[y][x] = sqrtf(smoothed(guide, x, y));
  }
  if (!(total > 0.0f)) return; // of no light nothing is learnt
  const float even = total * (EVEN_SHARE / (1.0f - EVEN_SHARE) / OLX_SKY_BINS);
  for (uint32_t y = 0; y < OLX_SKY_DOWN; y++) {
    rows[y] = 0.0f;
    for (uint32_t x = 0; x < OLX_SKY_ACROSS; x++) rows[y] += weights[y][x] += even;
    olx_distribution_build(weights[y], OLX_SKY_ACROSS, guide->column_sums[y]);
  }
  olx_distribution_build(rows, OLX_SKY_DOWN, guide->row_sums);
  guide->stage++;
}

void olx_sky_guide_next(olx_sky_guide *guide, uint32_t index) {
  const bool power_of_four = index && !(index & (index - 1)) && (index & 0x55555555u);
  if (power_of_four) learn(guide);
}

olx_sampler olx_sky_guide_sampler(const olx_sky_guide *guide, const olx_sampler *sampler) {
  olx_sampler own = *sampler;
  if (guide->stage) own.seed = olx_hash2(own.seed, guide->stage);
  return own;
}

static float bin_density(const olx_sky_guide *guide, uint32_t x, uint32_t y) {
  return olx_distribution_probability(guide->row_sums, y) * olx_distribution_probability(guide->column_sums[y], x) *
         OLX_SKY_BINS;
}

olx_vec2 olx_sky_guide_warp(const olx_sky_guide *guide, olx_vec2 even, float *density) {
  *density = 1.0f;
  if (!guide->stage) return even;
  float rest_x, rest_y;
  const uint32_t y = olx_distribution_draw(guide->row_sums, OLX_SKY_DOWN, even.y, &rest_y);
  const uint32_t x = olx_distribution_draw(guide->column_sums[y], OLX_SKY_ACROSS, even.x, &rest_x);
  *density = bin_density(guide, x, y);
  return (olx_vec2){((float)x + rest_x) / OLX_SKY_ACROSS, ((float)y + rest_y) / OLX_SKY_DOWN};
}

float olx_sky_guide_density(const olx_sky_guide *guide, olx_vec2 point) {
  if (!guide->stage) return 1.0f;
  const uint32_t bin = bin_of(point);
  return bin_density(guide, bin % OLX_SKY_ACROSS, bin / OLX_SKY_ACROSS);
}
