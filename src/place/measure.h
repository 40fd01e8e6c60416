// Judging probes by surfels that their placement never used.
#ifndef OLX_PLACE_MEASURE_H
#define OLX_PLACE_MEASURE_H

#include "place/visibility.h"

#include <octalux/place.h>

// Fills gains and buried flags of the probes, and the report but for what only the placement knows.
olx_result olx_measure_probes(const olx_space *space, const olx_sight *sight, olx_probe_set *set);

#endif
