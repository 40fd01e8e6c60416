// The nearest probe, then the Delaunay neighbours in the direction where a ray is stuck (Wang 2018, section 4.1).
#ifndef OLX_SELECT_VORONOI_H
#define OLX_SELECT_VORONOI_H

#include "field/selector_data.h"

// The probe nearest to a point, the first of several; buried ones only when `buried`. OLX_NO_PROBE when there is none.
uint32_t olx_voronoi_nearest(const olx_field *field, olx_vec3 point, bool buried);

// The neighbours of a probe that are nearest in angle to a direction (any length) from it, best first; OLX_NO_PROBE
// fills the rest. Names no probe beyond the field's, whatever the file holds.
void olx_voronoi_neighbours(const olx_field *field, uint32_t probe, olx_vec3 direction, uint32_t choices[OLX_CHOICES]);

#endif
