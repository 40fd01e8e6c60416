// Builds a sparse voxel octree over the scene with up to four probes per leaf (Wang 2018, section 4.2).
#ifndef OLX_BAKE_OCTREE_BUILD_H
#define OLX_BAKE_OCTREE_BUILD_H

#include "bake/selectors/selector_input.h"

// Returns the number of levels of subdivision for light field maps of `radiance_size` texels along a side. The smallest
// leaves are about as large as a texel's footprint at half the scene's extent; 9 levels from 512 texels on, as in the
// thesis.
static inline uint32_t olx_octree_levels(uint32_t radiance_size) {
  uint32_t levels = 3;
  while (levels < 9 && 1u << levels < radiance_size) levels++;
  return levels;
}

// Builds the chunk OCTR. No leaf names a buried probe.
olx_result olx_octree_build(const olx_selector_input *input, void **data, size_t *size_bytes);

#endif
