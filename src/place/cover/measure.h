// Measures the coverage of probes by held-out surfels, which their placement never used.
#ifndef OLX_PLACE_MEASURE_H
#define OLX_PLACE_MEASURE_H

#include "place/cover/visibility.h"

#include <octalux/place.h>

// Fills the gains and buried flags of the probes, marks of surfaces when settings request them, and the report except
// for what only the placement knows. In worlds of many tiles, a probe counts for the surfaces of its own tile and of
// its neighbours.
olx_result olx_measure_probes(olx_world *world, const olx_sight *sight, olx_probe_set *set);

// Measures only the coverage of the set's probes, by the same surfels as olx_measure_probes. Fills their buried flags.
olx_result olx_measure_coverage(const olx_space *space, const olx_sight *sight, olx_probe_set *set, double *coverage);

#endif
