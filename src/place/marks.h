// Marks that an image of a placement shows besides the probes.
#ifndef OLX_PLACE_MARKS_H
#define OLX_PLACE_MARKS_H

#include "place/skeleton/skeleton.h"

// Appends marks for up to a few thousand of the surfels of a tile, of which there are `tiles`, that fewer than
// settings.views probes see well; views[i] is the number of probes that see surfel i well.
olx_result olx_mark_uncovered(const olx_surfels *surfels, const uint8_t *views, uint32_t tiles, olx_probe_set *set);
// Appends marks for up to a few thousand of the surfaces of a tile, of which there are `tiles`, that face space which
// is cut off.
olx_result olx_mark_unreached(const olx_surfels *area, uint32_t tiles, olx_probe_set *set);
// Appends marks for the skeleton that the placement method uses.
olx_result olx_mark_skeleton(const olx_space *space, const olx_sight *sight, olx_probe_set *set);

#endif
