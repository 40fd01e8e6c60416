// Removes probes that others make redundant.
#ifndef OLX_PLACE_THIN_H
#define OLX_PLACE_THIN_H

#include "place/cover/tiles.h"

// Keeps those of the tiling's probes that cover most, chosen one after another by samples of all tiles: the pinned
// ones, then always the one that adds most, until there are `limit` or, without settings->count, until coverage is
// hardly below settings->coverage. The *count probes in *probes keep their order; a probe counts for its own tile and
// the neighbouring ones.
olx_result olx_tiling_thin(const olx_tiling *tiling, uint32_t limit, olx_candidate *probes, uint32_t *count);

#endif
