// Tests lists of links: added links are summed by surfel, and when there are too many, some are drawn at random so that
// on average no weight is lost.
#include "bake/relight/few_links.h"

#include "core/sampling.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { SURFELS = 200, MOST = 40, DRAWS = 4096 };

static olx_link_list begin(uint32_t surfels) {
  olx_link_list list;
  assert_int_equal(olx_link_list_create(&list, surfels), OLX_OK);
  return list;
}

static bool near(double value, double expected, double share) {
  return fabs(value - expected) <= share * fabs(expected);
}

static bool near3(olx_vec3 value, olx_vec3 expected, double share) {
  return near((double)value.x, (double)expected.x, share) && near((double)value.y, (double)expected.y, share) &&
         near((double)value.z, (double)expected.z, share);
}

// Returns the luminance of all links' weights together.
static double weight_of(const olx_few_link *links, uint32_t count) {
  double sum = 0.0;
  for (uint32_t i = 0; i < count; i++) sum += (double)olx_luminance(links[i].weight);
  return sum;
}

// ---- Sums

static void links_to_a_surfel_are_summed(void **state) {
  (void)state;
  olx_link_list list = begin(10);
  const olx_vec3 x = {1.0f, 0.0f, 0.0f}, z = {0.0f, 0.0f, 1.0f}, blue = {0.0f, 0.25f, 1.0f}, red = {0.5f, 0.125f, 0.0f};
  const olx_few_link links[] = {
      {7, blue, x, 0.25f}, {9, red, z, 0.0f}, {7, red, z, 0.125f}, {0, blue, z, 0.5f}, {9, red, x, 0.0f}};
  for (uint32_t i = 0; i < 5; i++) olx_link_list_add(&list, &links[i]);
  olx_few_link found[10];
  assert_int_equal(olx_link_list_take(&list, 10, 0.5f, found), 3);
  assert_int_equal(found[0].from, 7); // links come in the order in which surfels were first named
  assert_int_equal(found[1].from, 9);
  assert_int_equal(found[2].from, 0);
  const olx_vec3 wanted = {0.5f, 0.375f, 1.0f};
  assert_true(near3(found[0].weight, wanted, 1e-6) && near3(found[1].weight, olx_scale(red, 2.0f), 1e-6));
  assert_true(near((double)found[0].straight, 0.375, 1e-6) && found[1].straight == 0.0f);
  // Directions are weighted by luminance.
  const float l = olx_luminance(blue), m = olx_luminance(red);
  assert_true(near3(found[0].direction, olx_v3(l, 0.0f, m), 1e-6));
  assert_true(near3(found[1].direction, olx_v3(m, 0.0f, m), 1e-6));
  olx_link_list_free(&list);
}

// ---- A list whose weights differ by orders of magnitude

static olx_few_link some_link(uint32_t i) {
  const float random = olx_unit_float(olx_hash2(i, 5)), weight = random * random * random * random + 1e-4f;
  return (olx_few_link){.from = i * 3 % SURFELS,
                        .weight = olx_scale(olx_v3(1.0f, 0.5f, random), weight),
                        .direction = olx_v3(random, 1.0f - random, 0.5f),
                        .straight = 0.5f * weight};
}

static void fill(olx_link_list *list) {
  for (uint32_t i = 0; i < SURFELS; i++) {
    const olx_few_link link = some_link(i);
    olx_link_list_add(list, &link);
  }
}

// Fills a list and takes all of its links.
static void fill_and_keep(olx_link_list *list, olx_few_link links[SURFELS]) {
  fill(list);
  assert_int_equal(olx_link_list_take(list, SURFELS, 0.3f, links), SURFELS);
}

static void all_are_kept_where_there_is_room(void **state) {
  (void)state;
  olx_link_list list = begin(SURFELS);
  olx_few_link all[SURFELS];
  fill_and_keep(&list, all);
  for (uint32_t i = 0; i < SURFELS; i++) {
    const olx_few_link link = some_link(i);
    assert_int_equal(all[i].from, link.from);
    assert_true(near3(all[i].weight, link.weight, 1e-6) && near((double)all[i].straight, (double)link.straight, 1e-6));
    assert_true(near3(all[i].direction, olx_scale(link.direction, olx_luminance(link.weight)), 1e-6));
  }
  olx_link_list_free(&list);
}

static int heavier_first(const void *a, const void *b) {
  const double p = *(const double *)a, q = *(const double *)b;
  return p < q ? 1 : p > q ? -1 : 0;
}

// Returns the weight t for which the sum of min(1, weight / t) over all links is the number of links that there is room
// for.
static double threshold_of(const olx_few_link *all, uint32_t count, uint32_t most) {
  double weights[SURFELS], rest = 0.0;
  for (uint32_t i = 0; i < count; i++) rest += weights[i] = (double)olx_luminance(all[i].weight);
  qsort(weights, count, sizeof *weights, heavier_first);
  uint32_t heavy = 0;
  while (heavy < most - 1 && weights[heavy] >= rest / (most - heavy)) rest -= weights[heavy++];
  return rest / (most - heavy);
}

// Asserts that a drawn link equals the original, with all its parts scaled by the same factor.
static void assert_scaled(const olx_few_link *drawn, const olx_few_link *own, double scale) {
  assert_true(near3(drawn->weight, olx_scale(own->weight, (float)scale), 1e-4));
  assert_true(near3(drawn->direction, olx_scale(own->direction, (float)scale), 1e-4));
  assert_true(near((double)drawn->straight, (double)own->straight * scale, 1e-4));
}

static void assert_drawn(const olx_few_link *all, const olx_few_link *drawn, uint32_t count, double threshold) {
  uint32_t next = 0;
  for (uint32_t i = 0; i < SURFELS; i++) {
    const double weight = (double)olx_luminance(all[i].weight);
    const bool named = next < count && drawn[next].from == all[i].from;
    if (weight > threshold * 1.0001) assert_true(named); // every heavy link is kept
    if (named) assert_scaled(&drawn[next++], &all[i], fmax(threshold / weight, 1.0));
  }
  assert_int_equal(next, count); // each link once, in the order of the list
}

// Links heavier than a threshold are kept unchanged, and each lighter link that is drawn gets the threshold as its
// weight. The lighter links weigh a whole number of thresholds together, and as many of them are drawn, or one fewer by
// rounding.
static void too_many_are_drawn(void **state) {
  (void)state;
  olx_link_list list = begin(SURFELS);
  olx_few_link all[SURFELS], drawn[SURFELS];
  fill_and_keep(&list, all);
  const double threshold = threshold_of(all, SURFELS, MOST), sum = weight_of(all, SURFELS);
  uint32_t full = 0;
  for (uint32_t k = 0; k < DRAWS; k++) {
    fill(&list);
    const uint32_t count = olx_link_list_take(&list, MOST, ((float)k + 0.5f) / DRAWS, drawn);
    assert_true(count == MOST || count == MOST - 1);
    assert_drawn(all, drawn, count, threshold);
    assert_true(fabs(weight_of(drawn, count) - sum) <= threshold + 1e-5 * sum);
    full += count == MOST;
  }
  assert_true(full > DRAWS - 8);
  olx_link_list_free(&list);
}

// Averaged over DRAWS evenly spread numbers, a link keeps its weight: the number of draws that contain it differs by at
// most one from the share that its weight has of the threshold.
static void no_link_gains_or_loses_weight_on_average(void **state) {
  (void)state;
  olx_link_list list = begin(SURFELS);
  olx_few_link all[SURFELS], drawn[SURFELS];
  fill_and_keep(&list, all);
  const double threshold = threshold_of(all, SURFELS, MOST);
  double sums[SURFELS] = {0};
  for (uint32_t k = 0; k < DRAWS; k++) {
    fill(&list);
    const uint32_t count = olx_link_list_take(&list, MOST, ((float)k + 0.5f) / DRAWS, drawn);
    for (uint32_t i = 0; i < count; i++) sums[drawn[i].from] += (double)olx_luminance(drawn[i].weight) / DRAWS;
  }
  for (uint32_t i = 0; i < SURFELS; i++) {
    const double weight = (double)olx_luminance(all[i].weight), off = sums[all[i].from] - weight;
    if (fabs(off) > 2.0 * threshold / DRAWS + 1e-5 * weight) {
      fail_msg("link %u weighs %g, on average %g (threshold %g)", i, weight, sums[all[i].from], threshold);
    }
  }
  olx_link_list_free(&list);
}

// ---- Ends of the range

// A link with an n-th of the weight is drawn for an n-th of the numbers, at any position in the list.
static void equal_links_are_drawn_in_turn(void **state) {
  (void)state;
  olx_link_list list = begin(SURFELS);
  uint32_t times[12] = {0};
  for (uint32_t k = 0; k < 12; k++) {
    for (uint32_t i = 0; i < 12; i++)
      olx_link_list_add(&list, &(olx_few_link){.from = i, .weight = {0.5f, 0.5f, 0.5f}});
    olx_few_link drawn[12];
    assert_int_equal(olx_link_list_take(&list, 4, ((float)k + 0.5f) / 12.0f, drawn), 4);
    for (uint32_t i = 0; i < 4; i++) {
      times[drawn[i].from]++;
      assert_true(near3(drawn[i].weight, olx_splat(1.5f), 1e-5));
    }
  }
  for (uint32_t i = 0; i < 12; i++) assert_int_equal(times[i], 4);
  olx_link_list_free(&list);
}

// Tests links without weight, room for a single link, and random numbers at the ends of their range.
static void few_remain_few(void **state) {
  (void)state;
  olx_link_list list = begin(SURFELS);
  olx_few_link drawn[SURFELS];
  assert_int_equal(olx_link_list_take(&list, MOST, 0.5f, drawn), 0);
  for (uint32_t i = 0; i < SURFELS; i++) olx_link_list_add(&list, &(olx_few_link){.from = i});
  assert_true(olx_link_list_take(&list, MOST, 0.5f, drawn) <= MOST);
  const float numbers[] = {0.0f, 0.5f, 0x1.fffffep-1f};
  for (uint32_t k = 0; k < 3; k++) {
    fill(&list);
    const double sum = weight_of(list.links, list.count);
    const uint32_t count = olx_link_list_take(&list, 1, numbers[k], drawn);
    assert_int_equal(count, 1);
    assert_true(near(weight_of(drawn, count), sum, 1e-5));
    fill(&list);
    assert_true(olx_link_list_take(&list, MOST, numbers[k], drawn) <= MOST);
  }
  olx_link_list_free(&list);
}

// After its links are taken, a list gives the same links as a new list would, bit by bit.
static void a_list_is_empty_afterwards(void **state) {
  (void)state;
  olx_link_list list = begin(SURFELS), other = begin(SURFELS);
  olx_few_link a[SURFELS] = {{0}}, b[SURFELS] = {{0}};
  fill(&list);
  olx_link_list_take(&list, 3, 0.9f, a);
  assert_int_equal(list.count, 0);
  memset(a, 0, sizeof a);
  fill(&list);
  fill(&other);
  assert_int_equal(olx_link_list_take(&list, MOST, 0.4f, a), olx_link_list_take(&other, MOST, 0.4f, b));
  assert_memory_equal(a, b, sizeof a);
  olx_link_list_free(&list);
  olx_link_list_free(&other);
}

static void a_list_of_no_surfels_is_sound(void **state) {
  (void)state;
  olx_link_list list = begin(0);
  olx_few_link none;
  assert_int_equal(olx_link_list_take(&list, MOST, 0.0f, &none), 0);
  olx_link_list_free(&list);
  assert_null(list.links);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(links_to_a_surfel_are_summed),
      cmocka_unit_test(all_are_kept_where_there_is_room),
      cmocka_unit_test(too_many_are_drawn),
      cmocka_unit_test(no_link_gains_or_loses_weight_on_average),
      cmocka_unit_test(equal_links_are_drawn_in_turn),
      cmocka_unit_test(few_remain_few),
      cmocka_unit_test(a_list_is_empty_afterwards),
      cmocka_unit_test(a_list_of_no_surfels_is_sound),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
