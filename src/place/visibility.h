// Which surfels are seen from which places, and how well.
#ifndef OLX_PLACE_VISIBILITY_H
#define OLX_PLACE_VISIBILITY_H

#include "core/parallel.h"
#include "place/surfels.h"

// How well a surfel is seen from `place`, if nothing stands between: 0 when it faces away, is seen at a grazing angle or
// with too large a texel; else from OLX_QUALITY_LEAST up to 255, better for steep angles and small distances.
#define OLX_QUALITY_LEAST 208
uint8_t olx_sight_quality(const olx_sight *sight, olx_vec3 place, const olx_surfel *surfel);

// The same for every surfel of an atlas, 0 where something stands between.
void olx_sight_row(const olx_space *space, const olx_sight *sight, olx_vec3 place, const olx_surfels *surfels,
                   uint8_t *quality);

// Rows of a matrix, qualities[surfels->count * i], for each place.
olx_result olx_visibility_matrix(const olx_space *space, const olx_sight *sight, const olx_vec3 *places, uint32_t count,
                                 const olx_surfels *surfels, uint32_t threads, olx_task *task, uint8_t *qualities);

// seen[i] = 1 when surfel i has a free line of sight from any of the places, at whatever angle and distance.
olx_result olx_lines_of_sight(const olx_space *space, const olx_vec3 *places, uint32_t count,
                              const olx_surfels *surfels, uint32_t threads, uint8_t *seen);

#endif
