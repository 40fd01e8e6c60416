// Candidate positions, from which placement chooses.
#ifndef OLX_PLACE_CANDIDATES_H
#define OLX_PLACE_CANDIDATES_H

#include "place/space/space.h"

#include <octalux/place.h>

typedef struct olx_candidate {
  olx_vec3 place;
  olx_probe_origin origin;
} olx_candidate;

// Finds about `wanted` positions that may hold probes: far voxels (maxima of the distance to surfaces, thinned), at
// most a third; points of `grid` that allow a probe, at most a sixth; the rest one from each of equal cells of the
// space that matters. The caller releases *candidates with olx_release.
olx_result olx_candidates_create(const olx_space *space, const olx_grid *grid, uint32_t wanted, uint32_t seed,
                                 olx_candidate **candidates, uint32_t *count);

#endif
