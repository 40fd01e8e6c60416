// Exchanges two probes of a cover for two others at once, where no single move is an improvement.
#ifndef OLX_PLACE_EXCHANGE_H
#define OLX_PLACE_EXCHANGE_H

#include "place/cover/cover_state.h"

// Removes pairs of the picks, from `pinned` on, and replaces them by the two candidates that cover most beside the
// others, if they cover more. Only for covers by one view; afterwards the levels are those of all picks.
olx_result olx_cover_exchange(olx_cover_state *state, uint32_t pinned, uint32_t seed);

#endif
