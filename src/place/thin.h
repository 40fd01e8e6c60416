// Dropping the probes that others make needless.
#ifndef OLX_PLACE_THIN_H
#define OLX_PLACE_THIN_H

#include "place/tiles.h"

// Keep those of the tiling's probes that cover most, chosen one after another by samples of all tiles: the pinned ones,
// then always the one that adds most, until there are `limit`, or, without settings->count, until hardly less is
// covered than settings->coverage allows to be missed. *probes, of which there are *count, keep their order; probes
// count for their own tile and those around it.
olx_result olx_tiling_thin(const olx_tiling *tiling, uint32_t limit, olx_candidate *probes, uint32_t *count);

#endif
