// Building bricks: cells of space that list the probes which see them (docs/maths.md, "Choosing probes").
#ifndef OLX_BAKE_BRICKS_BUILD_H
#define OLX_BAKE_BRICKS_BUILD_H

#include "bake/selector_input.h"
#include "field/brick_data.h"

// Returns the most bytes that bricks may take beside `map_bytes` of maps: 4 % of them, with a small lower bound and an
// upper bound of 4 MB.
uint64_t olx_bricks_budget(uint64_t map_bytes);

olx_result olx_bricks_build(const olx_selector_input *input, void **data, size_t *size_bytes);

#endif
