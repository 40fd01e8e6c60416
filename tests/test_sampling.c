// Tests random numbers and the distributions drawn from them, against what theory predicts for each.
#include "core/sampling.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { MOST_BINS = 4096 };

// Returns Pearson's statistic of counts against equal expectations, in standard deviations from its mean: above some
// 4.5 the numbers are not uniform random numbers, and below -4.5 they are too even to be random.
static double uniformity(const uint32_t *counts, uint32_t bins, double samples) {
  const double expected = samples / bins, freedom = bins - 1.0;
  double statistic = 0.0;
  for (uint32_t i = 0; i < bins; i++) statistic += (counts[i] - expected) * (counts[i] - expected) / expected;
  return (statistic - freedom) / sqrt(2.0 * freedom);
}

static void assert_uniform(const uint32_t *counts, uint32_t bins, double samples) {
  const double deviations = uniformity(counts, bins, samples);
  if (fabs(deviations) > 4.5) fail_msg("uniformity is %.1f standard deviations off", deviations);
}

// ---- hashes

static void hashes_of_successive_numbers_are_uniform(void **state) {
  (void)state;
  for (uint32_t shift = 0; shift < 32; shift += 8) {
    uint32_t one[256] = {0}, two[256] = {0}, two_swapped[256] = {0}, three[256] = {0};
    for (uint32_t i = 0; i < 65536; i++) {
      one[olx_hash(i) >> shift & 255u]++;
      two[olx_hash2(i & 255u, i >> 8) >> shift & 255u]++;
      two_swapped[olx_hash2(i, 7u) >> shift & 255u]++;
      three[olx_hash3(i & 15u, i >> 4 & 63u, i >> 10) >> shift & 255u]++;
    }
    assert_uniform(one, 256, 65536);
    assert_uniform(two, 256, 65536);
    assert_uniform(two_swapped, 256, 65536);
    assert_uniform(three, 256, 65536);
  }
}

static int compare_words(const void *a, const void *b) {
  const uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
  return (x > y) - (x < y);
}

static void hash_is_a_permutation_and_hash2_nearly_free_of_collisions(void **state) {
  (void)state;
  enum { COUNT = 1 << 18 };
  uint32_t *values = malloc(COUNT * sizeof *values);
  for (uint32_t i = 0; i < COUNT; i++) values[i] = olx_hash(i);
  qsort(values, COUNT, sizeof *values, compare_words);
  for (uint32_t i = 1; i < COUNT; i++) assert_true(values[i] != values[i - 1]);
  // Chance gives n^2 / 2^33 = 8 collisions; 25 are far more.
  for (uint32_t i = 0; i < COUNT; i++) values[i] = olx_hash2(i & 511u, i >> 9);
  qsort(values, COUNT, sizeof *values, compare_words);
  uint32_t collisions = 0;
  for (uint32_t i = 1; i < COUNT; i++) collisions += values[i] == values[i - 1];
  assert_in_range(collisions, 0, 25);
  free(values);
}

static void unit_floats_stay_below_one(void **state) {
  (void)state;
  assert_true(olx_unit_float(0) == 0.0f);
  assert_true(olx_unit_float(UINT32_MAX) < 1.0f);
  assert_true(olx_unit_float(0x80000000u) == 0.5f);
}

static void reversing_bits_twice_changes_nothing(void **state) {
  (void)state;
  assert_true(olx_reverse_bits(1u) == 0x80000000u);
  assert_true(olx_reverse_bits(0x0000F00Du) == 0xB00F0000u);
  for (uint32_t i = 0; i < 1000; i++) assert_true(olx_reverse_bits(olx_reverse_bits(olx_hash(i))) == olx_hash(i));
}

// ---- point sets

// Returns whether the 2^m points form a (0, m, 2)-net: each box of area 2^-m with power-of-two sides contains exactly
// one.
static bool is_net(const olx_vec2 *points, uint32_t m) {
  const uint32_t count = 1u << m;
  for (uint32_t a = 0; a <= m; a++) {
    uint8_t taken[MOST_BINS] = {0};
    for (uint32_t i = 0; i < count; i++) {
      const uint32_t x = (uint32_t)(points[i].x * (float)(1u << a)),
                     y = (uint32_t)(points[i].y * (float)(1u << (m - a)));
      uint8_t *box = &taken[x << (m - a) | y];
      if (*box) return false;
      *box = 1;
    }
  }
  return true;
}

static void hammersley_points_are_nets(void **state) {
  (void)state;
  olx_vec2 points[MOST_BINS];
  for (uint32_t m = 0; m <= 12; m++) {
    for (uint32_t i = 0; i < 1u << m; i++) points[i] = olx_hammersley(i, 1u << m);
    assert_true(is_net(points, m));
  }
}

// The second Sobol coordinate is the exclusive or of the direction numbers at the set bits of the index.
static void second_sobol_dimension_follows_its_direction_numbers(void **state) {
  (void)state;
  for (uint32_t i = 0; i < 200000; i++) {
    const uint32_t index = i < 100000 ? i : olx_hash(i);
    uint32_t expected = 0, direction = 0x80000000u;
    for (uint32_t bit = 0; bit < 32; bit++, direction ^= direction >> 1) {
      if (index >> bit & 1u) expected ^= direction;
    }
    assert_int_equal(olx_reverse_bits(olx_sobol2_reversed(index)), expected);
  }
}

// The first points of any power of two form a net, and so does every later block of that size, for any seed.
static void stratified_points_are_nets(void **state) {
  (void)state;
  olx_vec2 points[MOST_BINS];
  for (uint32_t seed = 0; seed < 40; seed++) {
    for (uint32_t m = 0; m <= 10; m++) {
      for (uint32_t block = 0; block < 3; block++) {
        for (uint32_t i = 0; i < 1u << m; i++) points[i] = olx_stratified2((block << m) + i, seed);
        assert_true(is_net(points, m));
      }
    }
  }
}

// Computes the L2 star discrepancy by Warnock's formula.
static double discrepancy(const olx_vec2 *points, uint32_t count) {
  double single = 0.0, pairs = 0.0;
  for (uint32_t i = 0; i < count; i++) {
    const double x = points[i].x, y = points[i].y;
    single += (1.0 - x * x) * (1.0 - y * y);
    for (uint32_t j = 0; j < count; j++) {
      pairs += (1.0 - fmax(x, (double)points[j].x)) * (1.0 - fmax(y, (double)points[j].y));
    }
  }
  return sqrt(1.0 / 9.0 - single / (2.0 * count) + pairs / ((double)count * count));
}

// Random points have an expected square of (1/4 - 1/9) / count; the discrepancy of low-discrepancy points falls with
// log(count) / count.
static void low_discrepancy_sets_are_what_they_are_called(void **state) {
  (void)state;
  enum { COUNT = 1024 };
  olx_vec2 hammersley[COUNT], stratified[COUNT], hashed[COUNT];
  for (uint32_t i = 0; i < COUNT; i++) {
    hammersley[i] = olx_hammersley(i, COUNT);
    stratified[i] = olx_stratified2(i, 5);
    hashed[i] = (olx_vec2){olx_unit_float(olx_hash2(i, 1)), olx_unit_float(olx_hash2(i, 2))};
  }
  const double random = sqrt((1.0 / 4.0 - 1.0 / 9.0) / COUNT), low = log2(COUNT) / COUNT;
  assert_true(discrepancy(hammersley, COUNT) < 0.25 * low);
  assert_true(discrepancy(stratified, COUNT) < 0.25 * low);
  assert_true(discrepancy(hashed, COUNT) > 0.4 * random && discrepancy(hashed, COUNT) < 2.0 * random);
}

// Each pixel uses a seed of its own, so the same sample of successive seeds must look random, in either dimension and
// in both.
static void a_sample_over_successive_seeds_is_uniform(void **state) {
  (void)state;
  for (uint32_t i = 0; i < 6; i++) {
    uint32_t square[256] = {0}, neighbours[256] = {0}, crossed[256] = {0};
    for (uint32_t seed = 0; seed < 65536; seed++) {
      const olx_vec2 p = olx_stratified2(i, seed), q = olx_stratified2(i, seed + 1u);
      square[(uint32_t)(p.x * 16.0f) << 4 | (uint32_t)(p.y * 16.0f)]++;
      neighbours[(uint32_t)(p.x * 16.0f) << 4 | (uint32_t)(q.x * 16.0f)]++;
      crossed[(uint32_t)(p.y * 16.0f) << 4 | (uint32_t)(q.x * 16.0f)]++;
    }
    assert_uniform(square, 256, 65536);
    assert_uniform(neighbours, 256, 65536);
    assert_uniform(crossed, 256, 65536);
  }
}

// ---- distributions

static olx_vec2 random_pair(uint32_t i, uint32_t salt) {
  return (olx_vec2){olx_unit_float(olx_hash3(i, salt, 0)), olx_unit_float(olx_hash3(i, salt, 1))};
}

enum { DRAWS = 1 << 17 };

static uint32_t azimuth_bin(olx_vec3 d) {
  const float turn = (atan2f(d.y, d.x) + OLX_PI) / (2.0f * OLX_PI);
  return (uint32_t)olx_min(turn * 16.0f, 15.0f);
}

// The pdf cos / pi makes the squared cosine uniform.
static void cosine_directions_follow_their_pdf(void **state) {
  (void)state;
  uint32_t counts[256] = {0};
  for (uint32_t i = 0; i < DRAWS; i++) {
    const olx_vec3 d = olx_sample_cosine(random_pair(i, 1));
    assert_true(d.z >= 0.0f);
    assert_true(fabsf(olx_length(d) - 1.0f) < 1e-6f);
    counts[(uint32_t)olx_min(d.z * d.z * 16.0f, 15.0f) << 4 | azimuth_bin(d)]++;
  }
  assert_uniform(counts, 256, DRAWS);
}

// Zones of a sphere with equal height have equal area (Archimedes).
static void sphere_directions_are_uniform(void **state) {
  (void)state;
  uint32_t counts[256] = {0};
  for (uint32_t i = 0; i < DRAWS; i++) {
    const olx_vec3 d = olx_sample_sphere(random_pair(i, 2));
    assert_true(fabsf(olx_length(d) - 1.0f) < 1e-6f);
    counts[(uint32_t)olx_min((d.z * 0.5f + 0.5f) * 16.0f, 15.0f) << 4 | azimuth_bin(d)]++;
  }
  assert_uniform(counts, 256, DRAWS);
}

// Returns the small triangle that contains barycentric (u, v), of 4^depth equal ones made by halving the sides.
static uint32_t small_triangle(float u, float v, uint32_t depth) {
  uint32_t index = 0;
  for (uint32_t i = 0; i < depth; i++) {
    const float w = 1.0f - u - v;
    const uint32_t which = u > 0.5f ? 1 : v > 0.5f ? 2 : w > 0.5f ? 0 : 3;
    if (which == 3) {
      u = 1.0f - 2.0f * u;
      v = 1.0f - 2.0f * v;
    } else {
      u = 2.0f * u - (which == 1 ? 1.0f : 0.0f);
      v = 2.0f * v - (which == 2 ? 1.0f : 0.0f);
    }
    index = index << 2 | which;
  }
  return index;
}

static void triangle_points_are_uniform(void **state) {
  (void)state;
  uint32_t counts[256] = {0};
  for (uint32_t i = 0; i < DRAWS; i++) {
    const olx_vec2 p = olx_sample_triangle(random_pair(i, 3));
    assert_true(p.x >= 0.0f && p.y >= 0.0f && p.x + p.y <= 1.000001f);
    counts[small_triangle(p.x, p.y, 4)]++;
  }
  assert_uniform(counts, 256, DRAWS);
}

// The corners of the unit square are valid input.
static void extreme_random_numbers_give_finite_directions(void **state) {
  (void)state;
  const float ends[] = {0.0f, 0x1.fffffep-1f};
  for (uint32_t i = 0; i < 4; i++) {
    const olx_vec2 random = {ends[i & 1], ends[i >> 1]};
    assert_true(fabsf(olx_length(olx_sample_cosine(random)) - 1.0f) < 1e-6f);
    assert_true(fabsf(olx_length(olx_sample_sphere(random)) - 1.0f) < 1e-6f);
    const olx_vec2 p = olx_sample_triangle(random);
    assert_true(p.x >= 0.0f && p.y >= 0.0f && p.x + p.y <= 1.000001f);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(hashes_of_successive_numbers_are_uniform),
      cmocka_unit_test(hash_is_a_permutation_and_hash2_nearly_free_of_collisions),
      cmocka_unit_test(unit_floats_stay_below_one),
      cmocka_unit_test(reversing_bits_twice_changes_nothing),
      cmocka_unit_test(hammersley_points_are_nets),
      cmocka_unit_test(second_sobol_dimension_follows_its_direction_numbers),
      cmocka_unit_test(stratified_points_are_nets),
      cmocka_unit_test(low_discrepancy_sets_are_what_they_are_called),
      cmocka_unit_test(a_sample_over_successive_seeds_is_uniform),
      cmocka_unit_test(cosine_directions_follow_their_pdf),
      cmocka_unit_test(sphere_directions_are_uniform),
      cmocka_unit_test(triangle_points_are_uniform),
      cmocka_unit_test(extreme_random_numbers_give_finite_directions),
  };
  return cmocka_run_group_tests_name("sampling", tests, NULL, NULL);
}
