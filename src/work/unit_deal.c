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
  return unit >= d->parts && !olx_unit_is_dealt(d, unit) && !is_stored(user, unit) && !is_stored(user, unit - d->parts);
}

static bool next_of_others(olx_unit_deal *d, olx_unit_test *is_stored, const void *user, uint32_t *unit) {
  const uint32_t start = (uint32_t)((uint64_t)(d->part - 1) * d->count / d->parts);
  while (d->visited < d->count) {
    const uint32_t back = start + d->visited++;
    *unit = d->count - 1 - (back < d->count ? back : back - d->count);
    if (needs_help(d, is_stored, user, *unit)) return true;
  }
  return false;
}

bool olx_unit_deal_next(olx_unit_deal *d, olx_unit_test *is_stored, const void *user, uint32_t *unit) {
  if (next_own(d, is_stored, user, unit)) return true;
  return d->helps && next_of_others(d, is_stored, user, unit);
}
