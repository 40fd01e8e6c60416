// Judging probes by surfels that their placement never used.
#ifndef OLX_PLACE_MEASURE_H
#define OLX_PLACE_MEASURE_H

#include "place/visibility.h"

#include <octalux/place.h>

// Fills gains and buried flags of the probes, marks of surfaces when the settings want some, and the report but for
// what only the placement knows. In worlds of many tiles probes count for surfaces of their own tile and of those
// around it.
olx_result olx_measure_probes(olx_world *world, const olx_sight *sight, olx_probe_set *set);

// The coverage alone of the set's probes, by the same surfels. Fills their buried flags.
olx_result olx_measure_coverage(const olx_space *space, const olx_sight *sight, olx_probe_set *set, double *coverage);

#endif
