// Twin of src/select/cage.h: the probes at the corners of a grid cell (McGuire et al. 2017, section 4.1, Figure 3).
//
// SPDX-License-Identifier: MIT
#ifndef OLX_CAGE_GLSL
#define OLX_CAGE_GLSL

#include "language.glsl" // comes first, because it sets precisions
#include "../octalux_shared.h"

// Corner i of a cell: bit 0 of i is x, bit 1 is y, bit 2 is z. An axis with one probe contributes one corner.
struct olx_cage {
  uvec3 base;
  uint corner_mask; // bits of i that distinguish probes
  vec3 alpha;       // the point's position in the cell along each axis, 0..1
};

olx_cage olx_cage_at(olx_gpu_grid grid, vec3 position) {
  olx_cage cage = olx_cage(uvec3(0), 0u, vec3(0.0));
  for (int axis = 0; axis < 3; axis++) {
    if (grid.count[axis] < 2u) continue;
    precise float x = (position[axis] - grid.origin[axis]) / grid.spacing[axis];
    float base = clamp(floor(x), 0.0, float(grid.count[axis] - 2u));
    cage.base[axis] = uint(base);
    cage.alpha[axis] = clamp(x - base, 0.0, 1.0);
    cage.corner_mask |= 1u << axis;
  }
  return cage;
}

bool olx_cage_has(olx_cage cage, uint corner) { return (corner & ~cage.corner_mask) == 0u; }

uint olx_cage_probe(olx_gpu_grid grid, olx_cage cage, uint corner) {
  uvec3 at = cage.base + uvec3(corner & 1u, corner >> 1 & 1u, corner >> 2 & 1u);
  return at.x + grid.count.x * (at.y + grid.count.y * at.z);
}

// Returns the trilinear weight of a corner.
float olx_cage_weight(olx_cage cage, uint corner) {
  float weight = 1.0;
  for (int axis = 0; axis < 3; axis++) {
    bool upper = (corner >> axis & 1u) != 0u;
    if ((cage.corner_mask >> axis & 1u) != 0u) weight *= upper ? cage.alpha[axis] : 1.0 - cage.alpha[axis];
  }
  return weight;
}

#endif
