// Deals the units of a stage to the parts of a bake.
#include "work/unit_deal.h"

olx_unit_deal olx_unit_deal_begin(const char *stage, uint32_t round, uint32_t count, uint32_t part, uint32_t parts) {
  uint32_t turn = round;
  for (const char *c = stage; *c; c++) turn = 31 * turn + (uint32_t)*c;
  const uint32_t first = (part - 1 + parts - turn % parts) % parts;
  return (olx_unit_deal){.first = first, .count = count, .part = part, .parts = parts, .next = first};
}

bool olx_unit_is_dealt(const olx_unit_deal *d, uint32_t unit) { return unit % d->parts == d->first; }

static bool next_own(olx_unit_deal *d, olx_unit_test *is_stored, const void *user, uint32_t *unit) {
  while (d->next < d->count) {
    *unit = d->next;
    d->next = d->count - d->next > d->parts ? d->next + d->parts : d->count;
    if (!is_stored(user, *unit)) return true;
  }
  return false;
}

// Returns whether the unit is missing and its own part has others to compute before it.
static bool needs_help(const olx_unit_deal *d, olx_unit_test *is_stored, const void *user, uint32_t unit) {
  if (olx_unit_is_dealt(d, unit) || is_stored(user, unit)) return false;
  for (uint32_t before = unit; before >= d->parts;) {
    before -= d->parts;
    if (!is_stored(user, before)) return true;
  }
  return false;
}

static uint32_t common_divisor(uint32_t a, uint32_t b) {
  while (b) {
    const uint32_t rest = a % b;
    a = b;
    b = rest;
  }
  return a;
}

// Chooses the part's order: steps that have no divisor in common with the count lead to every unit once.
static void choose_order(olx_unit_deal *d) {
  const uint32_t mixed = d->part * UINT32_C(2654435761); // 2^32 divided by the golden ratio
  d->step = 1 + mixed % d->count;
  while (common_divisor(d->step, d->count) != 1) d->step++;
  d->step %= d->count;
  d->place = (uint32_t)((uint64_t)(d->part - 1) * d->count / d->parts);
}

static bool next_of_others(olx_unit_deal *d, olx_unit_test *is_stored, const void *user, uint32_t *unit) {
  if (d->visited == 0 && d->count > 0) choose_order(d);
  while (d->visited < d->count) {
    *unit = d->place;
    d->visited++;
    d->place = (uint32_t)(((uint64_t)d->place + d->step) % d->count);
    if (needs_help(d, is_stored, user, *unit)) return true;
  }
  return false;
}

bool olx_unit_deal_next(olx_unit_deal *d, olx_unit_test *is_stored, const void *user, uint32_t *unit) {
  if (next_own(d, is_stored, user, unit)) return true;
  return d->helps && next_of_others(d, is_stored, user, unit);
}
