// A sparse voxel octree over the scene with up to four probes a leaf (Wang 2018, section 4.2).
#ifndef OLX_BAKE_OCTREE_BUILD_H
#define OLX_BAKE_OCTREE_BUILD_H

#include "bake/selector_input.h"

// Levels of subdivision for light field maps of `radiance_size` texels a side: so that the smallest leaves are about as
// large as texels are on surfaces half the scene away; 9 as in the thesis from 512 texels on.
static inline uint32_t olx_octree_levels(uint32_t radiance_size) {
  uint32_t levels = 3;
  while (levels < 9 && 1u << levels < radiance_size) levels++;
  return levels;
}

// The chunk OCTR. Buried probes are in no leaf.
olx_result olx_octree_build(const olx_selector_input *input, void **data, size_t *size_bytes);

#endif
