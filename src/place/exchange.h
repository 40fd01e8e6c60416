// Exchanging two probes of a cover for two others at once, where no single move helps.
#ifndef OLX_PLACE_EXCHANGE_H
#define OLX_PLACE_EXCHANGE_H

#include "place/cover_state.h"

// Take pairs of the picks away, from `pinned` on, and put in their places the two candidates that cover most beside the
// others, if they cover more. For covers by one view alone; the levels are those of all picks afterwards.
olx_result olx_cover_exchange(olx_cover_state *state, uint32_t pinned, uint32_t seed);

#endif
