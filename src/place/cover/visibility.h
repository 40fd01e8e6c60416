// Computes which surfels are seen from which positions, and how well.
#ifndef OLX_PLACE_VISIBILITY_H
#define OLX_PLACE_VISIBILITY_H

#include "core/parallel.h"
#include "place/cover/surfels.h"

// Computes the quality, by olx_sight_quality, at which every surfel of an atlas is seen from a position; 0 where
// something occludes it.
void olx_sight_row(const olx_space *space, const olx_sight *sight, olx_vec3 place, const olx_surfels *surfels,
                   uint8_t *quality);

// Counts views: views[i] is the number of positions that see surfel i well or, without `sight`, that have a free line
// of sight to it at any angle and distance; counted up to `most`, which is 1 to 255. first[i], when not NULL, is the
// first of them, or `count`.
olx_result olx_count_views(const olx_space *space, const olx_sight *sight, const olx_vec3 *places, uint32_t count,
                           const olx_surfels *surfels, uint32_t most, uint32_t threads, uint8_t *views,
                           uint32_t *first);

#endif
