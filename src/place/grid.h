// Places probes on a regular grid, where the description allows them.
#ifndef OLX_PLACE_GRID_H
#define OLX_PLACE_GRID_H

#include "place/cover/candidates.h"

// Places the pinned probes, then the grid's in its order, except the *rejected ones that the description's rules
// forbid. The caller releases *probes with olx_release.
olx_result olx_place_grid(const olx_scene *scene, const olx_grid *grid, olx_candidate **probes, uint32_t *count,
                          uint32_t *rejected);

#endif
