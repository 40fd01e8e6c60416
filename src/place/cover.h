// Choosing probes that cover the atlas: a greedy weighted set cover, then moves and swaps.
#ifndef OLX_PLACE_COVER_H
#define OLX_PLACE_COVER_H

#include "place/candidates.h"
#include "place/visibility.h"

// Probes that are there before any is chosen, and stay.
typedef struct olx_fixed_probes {
  const olx_candidate *items;
  uint32_t count;
} olx_fixed_probes;

typedef struct olx_cover_result {
  olx_candidate *probes; // the fixed ones first; released with olx_release
  uint32_t count;
  uint32_t candidates; // considered
} olx_cover_result;

// The fixed probes, and so many of the candidates that settings->count is reached, or settings->coverage of what can be
// covered in the tile. OLX_ERROR_EMPTY when nothing of it is seen.
olx_result olx_cover(const olx_space *space, const olx_sight *sight, olx_fixed_probes fixed,
                     const olx_place_settings *settings, olx_task *task, olx_cover_result *result);

#endif
