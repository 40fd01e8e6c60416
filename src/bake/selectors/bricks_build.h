// Building bricks: cells of space that list the probes which see them (docs/maths.md, "Choosing probes").
#ifndef OLX_BAKE_BRICKS_BUILD_H
#define OLX_BAKE_BRICKS_BUILD_H

#include "bake/selectors/selector_input.h"
#include "field/brick_data.h"

// Builds bricks that take at most olx_bricks_budget of input->map_bytes.
olx_result olx_bricks_build(const olx_selector_input *input, void **data, size_t *size_bytes);

#endif
