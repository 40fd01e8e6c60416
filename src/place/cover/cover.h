// Chooses probes that cover the atlas: a greedy weighted set cover, then moves and swaps.
#ifndef OLX_PLACE_COVER_H
#define OLX_PLACE_COVER_H

#include "place/cover/candidates.h"
#include "place/cover/visibility.h"

// Probes that exist before any is chosen, and stay.
typedef struct olx_fixed_probes {
  const olx_candidate *items;
  uint32_t count;
} olx_fixed_probes;

typedef struct olx_cover_result {
  olx_candidate *probes; // the fixed ones first; release with olx_release
  uint32_t count;
  uint32_t candidates; // number of candidates considered
} olx_cover_result;

// Chooses the fixed probes and as many candidates as settings->count requires, or as settings->coverage of what can be
// covered in the tile requires. Returns OLX_ERROR_EMPTY when none of the tile is visible.
olx_result olx_cover(const olx_space *space, const olx_sight *sight, olx_fixed_probes fixed,
                     const olx_place_settings *settings, olx_task *task, olx_cover_result *result);

#endif
