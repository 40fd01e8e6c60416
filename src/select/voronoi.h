// Finds the nearest probe, and the Delaunay neighbours towards the place where a ray was lost (Wang 2018, section 4.1).
#ifndef OLX_SELECT_VORONOI_H
#define OLX_SELECT_VORONOI_H

#include "field/selector_data.h"

// Returns the probe nearest to a point, the first of several. Buried probes (inside geometry) count only when `buried`
// is set. OLX_NO_PROBE when there is none.
uint32_t olx_voronoi_nearest(const olx_field *field, olx_vec3 point, bool buried);

// Returns the neighbours of a probe whose directions are nearest in angle to a direction (of any length), best first;
// OLX_NO_PROBE fills the free places. Every other value is a probe of the field, whatever the file holds.
void olx_voronoi_neighbours(const olx_field *field, uint32_t probe, olx_vec3 direction, uint32_t choices[OLX_CHOICES]);

#endif
