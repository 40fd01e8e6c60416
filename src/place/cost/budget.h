// The number of probes whose field fits a budget of bytes.
#ifndef OLX_PLACE_BUDGET_H
#define OLX_PLACE_BUDGET_H

#include "place/cover/candidates.h"
#include "place/space/world.h"

// Finds the most probes whose field is expected to fit settings->budget_mb, from what is seen from places spread over
// the space that matters. OLX_ERROR_ARGUMENT where not even one fits.
olx_result olx_budget_count(const olx_world *world, const olx_place_settings *settings, uint32_t *count);

// Computes set->report.field_bytes of the first set->count `probes`, where the settings ask for it. Where that is more
// than the budget, because these probes see more than places on average, lowers set->count until they fit; pinned
// probes stay, one stays at least, and all of a grid stay.
olx_result olx_budget_keep(const olx_scene *scene, const olx_candidate *probes, olx_probe_set *set);

#endif
