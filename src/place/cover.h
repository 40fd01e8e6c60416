// Choosing probes that cover the atlas: a greedy weighted set cover, then moves and swaps.
#ifndef OLX_PLACE_COVER_H
#define OLX_PLACE_COVER_H

#include "place/candidates.h"
#include "place/visibility.h"

typedef struct olx_cover_result {
  olx_candidate *probes; // the pinned ones first; released with olx_release
  uint32_t count;
  uint32_t candidates; // considered
} olx_cover_result;

// The pinned probes of the description, and so many of the candidates that settings->count is reached, or
// settings->coverage of what can be covered.
olx_result olx_cover(const olx_space *space, const olx_sight *sight, const olx_place_settings *settings, olx_task *task,
                     olx_cover_result *result);

#endif
