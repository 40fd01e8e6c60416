// Finds the leaf of a sparse voxel octree and the probes baked into it (Wang 2018, section 4.2).
#ifndef OLX_SELECT_OCTREE_H
#define OLX_SELECT_OCTREE_H

#include "field/selector_data.h"

#define OLX_NO_LEAF UINT32_MAX

// Returns the leaf around a point, or the nearest leaf for points outside the root. OLX_NO_LEAF when the nodes are
// damaged.
uint32_t olx_octree_leaf(const olx_field *field, olx_vec3 point);

// Returns the probes of a leaf, best first; OLX_NO_PROBE fills the free places, and all places for OLX_NO_LEAF. Every
// other value is a probe of the field, whatever the file holds.
void olx_octree_choices(const olx_field *field, uint32_t leaf, uint32_t choices[OLX_CHOICES]);

#endif
