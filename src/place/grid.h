// Probes on a regular grid, as far as the description allows.
#ifndef OLX_PLACE_GRID_H
#define OLX_PLACE_GRID_H

#include "place/candidates.h"

// The pinned probes, then the grid's in its order without those that the description's rules forbid, of which there are
// *rejected. *probes is the caller's to release with olx_release.
olx_result olx_place_grid(const olx_scene *scene, const olx_grid *grid, olx_candidate **probes, uint32_t *count,
                          uint32_t *rejected);

#endif
