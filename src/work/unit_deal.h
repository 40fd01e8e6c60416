// The rule that deals the units of a stage to the parts of a bake: which part computes which unit, and in which order.
//
// Units are dealt to the parts in turn, and each stage begins with another part, so that the steps that are one unit
// each do not all fall to the same part. A part computes its own units in ascending order. A part that helps then
// computes units of others: those that are missing, but not the first missing one of their own part, which that part is
// probably computing. It goes through the stage in an order of its own, so that helpers rarely meet.
//
// The rule sees only which units are stored, so that bench/studies can simulate it for any number of parts.
#ifndef OLX_WORK_UNIT_DEAL_H
#define OLX_WORK_UNIT_DEAL_H

#include <stdbool.h>
#include <stdint.h>

// The way of one part through the units of one stage in one round.
typedef struct olx_unit_deal {
  uint32_t first, count; // the part's first unit; units of the stage
  uint32_t part, parts;  // from 1 to `parts`
  bool helps;            // also computes units of others
  uint32_t next;         // the next of its own units
  uint32_t visited;      // units of others that were looked at
  uint32_t place, step;  // the next unit to look at, and the way from it to the one after it
} olx_unit_deal;

olx_unit_deal olx_unit_deal_begin(const char *stage, uint32_t round, uint32_t count, uint32_t part, uint32_t parts);

// Returns whether the unit belongs to the part.
bool olx_unit_is_dealt(const olx_unit_deal *deal, uint32_t unit);

// Returns whether a unit is stored.
typedef bool olx_unit_test(const void *user, uint32_t unit);

// Finds the next unit that the part is to compute; returns false when there is none.
bool olx_unit_deal_next(olx_unit_deal *deal, olx_unit_test *is_stored, const void *user, uint32_t *unit);

#endif
