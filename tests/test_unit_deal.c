// Tests the rule that deals units to the parts of a bake: every unit belongs to one part, parts that help leave nothing
// to wait for but what others are at, and stages begin with different parts.
#include "work/unit_deal.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>

#include <cmocka.h>

enum { MOST_UNITS = 1000 };

static bool is_stored(const void *user, uint32_t unit) { return ((const bool *)user)[unit]; }

// Each unit is some part's own, and a part alone computes exactly its own units, in ascending order.
static void deals_every_unit_once(void **state) {
  (void)state;
  for (uint32_t parts = 1; parts <= 70; parts += 3) {
    uint32_t owners[MOST_UNITS] = {0};
    const bool nothing[MOST_UNITS] = {false};
    const uint32_t count = 17 * parts % 131;
    for (uint32_t part = 1; part <= parts; part++) {
      olx_unit_deal deal = olx_unit_deal_begin("cast", 2, count, part, parts);
      uint32_t unit, last = 0;
      while (olx_unit_deal_next(&deal, is_stored, nothing, &unit)) {
        assert_true(unit < count && olx_unit_is_dealt(&deal, unit));
        assert_true(unit >= last);
        last = unit;
        owners[unit]++;
      }
    }
    for (uint32_t unit = 0; unit < count; unit++) assert_int_equal(owners[unit], 1);
  }
}

static void skips_what_is_stored(void **state) {
  (void)state;
  const bool stored[] = {true, false, true, true, false};
  olx_unit_deal deal = olx_unit_deal_begin("probe", 0, 5, 1, 1);
  uint32_t unit;
  assert_true(olx_unit_deal_next(&deal, is_stored, stored, &unit));
  assert_int_equal(unit, 1);
  assert_true(olx_unit_deal_next(&deal, is_stored, stored, &unit));
  assert_int_equal(unit, 4);
  assert_false(olx_unit_deal_next(&deal, is_stored, stored, &unit));
}

// A helper whose companions store nothing leaves each of them the one unit that it is at, and computes no unit twice.
static void leaves_others_the_unit_they_are_at(void **state) {
  (void)state;
  enum { PARTS = 5, COUNT = 203 };
  bool stored[COUNT] = {false};
  olx_unit_deal deal = olx_unit_deal_begin("probe", 0, COUNT, 3, PARTS);
  uint32_t unit, left[PARTS] = {0};
  deal.helps = true;
  while (olx_unit_deal_next(&deal, is_stored, stored, &unit)) {
    assert_false(stored[unit]);
    stored[unit] = true;
  }
  for (unit = 0; unit < COUNT; unit++) left[unit % PARTS] += !stored[unit];
  for (uint32_t part = 0; part < PARTS; part++) assert_int_equal(left[part], part != deal.first);
}

// Steps of one unit each are spread over the parts.
static void spreads_single_units(void **state) {
  (void)state;
  enum { PARTS = 4, ROUNDS = 40 };
  uint32_t shares[PARTS] = {0};
  for (uint32_t round = 0; round < ROUNDS; round++) {
    for (uint32_t part = 1; part <= PARTS; part++) {
      const olx_unit_deal deal = olx_unit_deal_begin("light", round, 1, part, PARTS);
      shares[part - 1] += olx_unit_is_dealt(&deal, 0);
    }
  }
  for (uint32_t part = 0; part < PARTS; part++) assert_int_equal(shares[part], ROUNDS / PARTS);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(deals_every_unit_once),
      cmocka_unit_test(skips_what_is_stored),
      cmocka_unit_test(leaves_others_the_unit_they_are_at),
      cmocka_unit_test(spreads_single_units),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
