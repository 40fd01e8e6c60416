// The direct light of surfels: the mean over points of a surfel's cell, and whether the sun reaches all of them.
#ifndef OLX_LIGHT_LIGHT_DIRECT_H
#define OLX_LIGHT_LIGHT_DIRECT_H

#include "light/solution/light_ranges.h"

// The direct light of each surfel (olx_surfel_lit). Points of surfels must be in memory to fill it.
extern const olx_light_ranges olx_direct_ranges;

#endif
