// Tests guided rays: their densities integrate to one, rays follow them, and means do not depend on them.
#include "core/sampling.h"
#include "light/links/ray_guide.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

enum { RAYS = 4096 };

// Returns light that comes mostly from one corner of the square, and a little from everywhere.
static float corner_light(olx_vec2 p) { return p.x > 0.8f && p.y < 0.2f ? 10.0f : 0.1f; }

static olx_ray_pool learn(float (*light)(olx_vec2)) {
  olx_guide_sums sums = {0};
  for (uint32_t i = 0; i < RAYS; i++) {
    const olx_vec2 point = olx_stratified2(i, 1);
    olx_guide_add(&sums, point, light(point));
  }
  olx_ray_pool pool;
  olx_guide_learn(&pool, &sums);
  return pool;
}

static float no_light(olx_vec2 p) { return 0.0f * p.x; }
static float even_light(olx_vec2 p) { return 2.0f + 0.0f * p.x; }

static void a_density_has_a_mean_of_one_and_leaves_nothing_out(void **state) {
  (void)state;
  float (*const lights[])(olx_vec2) = {corner_light, even_light, no_light};
  for (uint32_t k = 0; k < 3; k++) {
    const olx_ray_pool pool = learn(lights[k]);
    float sum = 0.0f;
    for (uint32_t i = 0; i < OLX_GUIDE_BINS; i++) {
      assert_true(pool.density[i] >= 0.25f);
      sum += pool.density[i];
    }
    assert_float_equal(sum / OLX_GUIDE_BINS, 1.0f, 1e-5f);
  }
}

static void where_all_directions_bring_alike_rays_stay_even(void **state) {
  (void)state;
  float (*const lights[])(olx_vec2) = {even_light, no_light};
  for (uint32_t k = 0; k < 2; k++) {
    const olx_ray_pool pool = learn(lights[k]);
    assert_float_equal(pool.spread, 1.0f, 0.0f);
    for (uint32_t i = 0; i < OLX_GUIDE_BINS; i++) assert_float_equal(pool.density[i], 1.0f, 1e-5f);
  }
}

// A ray's light, weighted by how many there are in its bin, has the mean of light, and its variance is lower by the
// factor that the pool predicts.
static void guided_rays_have_the_variance_that_the_pool_predicts(void **state) {
  (void)state;
  const olx_ray_pool pool = learn(corner_light);
  const olx_ray_pool *const pools[] = {&pool, NULL};
  const olx_bin_sequence sequence = olx_bin_sequence_make(2);
  double mean[2] = {0}, variance[2] = {0};
  for (uint32_t k = 0; k < 2; k++) {
    uint16_t bins[OLX_GUIDE_BINS];
    olx_guide_divide(pools[k], RAYS, bins);
    for (uint32_t bin = 0; bin < OLX_GUIDE_BINS; bin++) {
      for (uint32_t i = 0; i < bins[bin]; i++) {
        const olx_vec2 p = olx_bin_sequence_point(&sequence, olx_bin_sequence_index(&sequence, bin, i));
        const double light = (double)corner_light(p) * RAYS / (OLX_GUIDE_BINS * bins[bin]);
        mean[k] += light / RAYS;
        variance[k] += light * light / RAYS;
      }
    }
    variance[k] -= mean[k] * mean[k];
  }
  assert_float_equal((float)mean[0], (float)mean[1], 0.01f * (float)mean[1]);
  assert_true(variance[0] < 0.5 * variance[1]);
  assert_float_equal((float)(variance[0] / variance[1]), pool.spread, 0.2f * pool.spread);
}

// Returns the mean over bins of the mean over the rays that a pool gives to each.
static double divided_mean(const olx_ray_pool *pool, uint32_t rays, uint32_t seed) {
  uint16_t bins[OLX_GUIDE_BINS];
  const olx_bin_sequence sequence = olx_bin_sequence_make(seed);
  double sum = 0.0;
  olx_guide_divide(pool, rays, bins);
  for (uint32_t bin = 0; bin < OLX_GUIDE_BINS; bin++) {
    for (uint32_t i = 0; i < bins[bin]; i++) {
      const olx_vec2 p = olx_bin_sequence_point(&sequence, olx_bin_sequence_index(&sequence, bin, i));
      sum += (double)corner_light(p) / (OLX_GUIDE_BINS * bins[bin]);
    }
  }
  return sum;
}

static void divided_rays_find_the_same_mean_with_less_variance(void **state) {
  (void)state;
  enum { SEEDS = 400, FEW = 256 };
  const olx_ray_pool pool = learn(corner_light);
  const olx_ray_pool *const pools[] = {&pool, NULL};
  double truth = 0.0, squares[2] = {0};
  for (uint32_t i = 0; i < RAYS; i++) truth += (double)corner_light(olx_stratified2(i, 2)) / RAYS;
  for (uint32_t k = 0; k < 2; k++) {
    double mean = 0.0;
    for (uint32_t seed = 0; seed < SEEDS; seed++) {
      const double found = divided_mean(pools[k], FEW, seed);
      mean += found / SEEDS;
      squares[k] += (found - truth) * (found - truth) / SEEDS;
    }
    assert_float_equal((float)mean, (float)truth, 0.01f * (float)truth);
  }
  assert_true(squares[0] < 0.5 * squares[1]);
}

// Each bin has a power of two of rays, about as many as its density says.
static void bins_have_rays_by_their_density(void **state) {
  (void)state;
  enum { FEW = 64, MANY = 32768 };
  const olx_ray_pool pool = learn(corner_light);
  uint16_t bins[OLX_GUIDE_BINS];
  for (uint32_t rays = FEW; rays <= MANY; rays *= 2) {
    uint32_t sum = 0;
    olx_guide_divide(&pool, rays, bins);
    for (uint32_t i = 0; i < OLX_GUIDE_BINS; i++) {
      assert_true(bins[i] >= 1 && (bins[i] & (bins[i] - 1)) == 0);
      sum += bins[i];
    }
    assert_int_equal(sum, rays);
  }
  for (uint32_t i = 0; i < OLX_GUIDE_BINS; i++) {
    const float ratio = (float)bins[i] / (pool.density[i] * MANY / OLX_GUIDE_BINS);
    assert_true(ratio >= 0.5f && ratio < 4.0f);
  }
  olx_guide_divide(NULL, 2 * OLX_GUIDE_BINS, bins);
  for (uint32_t i = 0; i < OLX_GUIDE_BINS; i++) assert_int_equal(bins[i], 2);
}

// A guide that changes in one bin leaves the number of rays nearly the same in all others.
static void a_changed_bin_changes_few_others(void **state) {
  (void)state;
  enum { FEW = 256 };
  olx_ray_pool pool = learn(corner_light);
  uint16_t bins[OLX_GUIDE_BINS], changed[OLX_GUIDE_BINS];
  uint32_t same = 0;
  olx_guide_divide(&pool, FEW, bins);
  pool.density[9] *= 2.0f;
  olx_guide_divide(&pool, FEW, changed);
  for (uint32_t i = 0; i < OLX_GUIDE_BINS; i++) same += bins[i] < changed[i] ? bins[i] : changed[i];
  assert_true(same >= FEW - 16);
}

// Points of a bin lie in it, all bins together make up the sequence, and each bin's points are evenly distributed.
static void a_sequence_by_bins_is_a_sequence(void **state) {
  (void)state;
  enum { NUMBERS = 16, SEEDS = 20, CELLS = 4 };
  for (uint32_t seed = 0; seed < SEEDS; seed++) {
    const olx_bin_sequence sequence = olx_bin_sequence_make(olx_hash(seed));
    bool met[OLX_GUIDE_BINS * NUMBERS] = {0};
    for (uint32_t bin = 0; bin < OLX_GUIDE_BINS; bin++) {
      bool cells[CELLS * CELLS] = {0};
      for (uint32_t i = 0; i < NUMBERS; i++) {
        const uint32_t index = olx_bin_sequence_index(&sequence, bin, i);
        const olx_vec2 p = olx_bin_sequence_point(&sequence, index);
        const float x = p.x * OLX_GUIDE_SIDE - (float)(bin % OLX_GUIDE_SIDE),
                    y = p.y * OLX_GUIDE_SIDE - (float)(bin / OLX_GUIDE_SIDE);
        assert_true(x >= 0.0f && x < 1.0f && y >= 0.0f && y < 1.0f);
        assert_int_equal(index / OLX_GUIDE_BINS, i);
        assert_false(met[index]);
        met[index] = true;
        bool *cell = &cells[(uint32_t)(y * CELLS) * CELLS + (uint32_t)(x * CELLS)];
        assert_false(*cell);
        *cell = true;
      }
    }
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_density_has_a_mean_of_one_and_leaves_nothing_out),
      cmocka_unit_test(where_all_directions_bring_alike_rays_stay_even),
      cmocka_unit_test(guided_rays_have_the_variance_that_the_pool_predicts),
      cmocka_unit_test(divided_rays_find_the_same_mean_with_less_variance),
      cmocka_unit_test(bins_have_rays_by_their_density),
      cmocka_unit_test(a_changed_bin_changes_few_others),
      cmocka_unit_test(a_sequence_by_bins_is_a_sequence),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
