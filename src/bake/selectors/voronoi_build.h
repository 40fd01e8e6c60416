// Maps of Delaunay neighbours (Wang 2018, section 4.1.2): for each direction from a probe, the neighbours nearest in
// angle.
#ifndef OLX_BAKE_VORONOI_BUILD_H
#define OLX_BAKE_VORONOI_BUILD_H

#include "bake/selectors/selector_input.h"

enum { OLX_VORONOI_SIZE = 16 }; // texels along a side of a map: 13 degrees, where neighbours are some 60 apart

// Builds the chunk VORO. Buried probes have no neighbours and are neighbours of no probe.
olx_result olx_voronoi_build(const olx_selector_input *input, void **data, size_t *size_bytes);

#endif
