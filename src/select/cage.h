// The cage: the probes at the corners of a grid cell (McGuire et al. 2017, section 4.1, Figure 3).
// Its twin is shaders/lib/cage.glsl.
#ifndef OLX_SELECT_CAGE_H
#define OLX_SELECT_CAGE_H

#include "field/field_data.h"

// Corner i of a cell: bit 0 of i is x, bit 1 is y, bit 2 is z. An axis with one probe contributes one corner, so some
// of the eight may be missing.
typedef struct olx_cage {
  uint32_t base[3];
  uint32_t corner_mask; // bits of i that distinguish probes: 7 when every axis has two probes or more
  float alpha[3];       // the point's position in the cell along each axis, 0..1
} olx_cage;

static inline olx_cage olx_cage_at(const olx_grid *grid, olx_vec3 position) {
  olx_cage cage = {.corner_mask = 0};
  for (uint32_t axis = 0; axis < 3; axis++) {
    const uint32_t count = grid->count[axis];
    if (count < 2) continue;
    const float x =
        (olx_component(position, axis) - olx_component(grid->origin, axis)) / olx_component(grid->spacing, axis);
    const float base = olx_clamp(floorf(x), 0.0f, (float)(count - 2));
    cage.base[axis] = (uint32_t)base;
    cage.alpha[axis] = olx_clamp(x - base, 0.0f, 1.0f);
    cage.corner_mask |= 1u << axis;
  }
  return cage;
}

static inline bool olx_cage_has(const olx_cage *cage, uint32_t corner) { return (corner & ~cage->corner_mask) == 0; }

static inline uint32_t olx_cage_probe(const olx_grid *grid, const olx_cage *cage, uint32_t corner) {
  const uint32_t x = cage->base[0] + (corner & 1u), y = cage->base[1] + (corner >> 1 & 1u),
                 z = cage->base[2] + (corner >> 2 & 1u);
  return x + grid->count[0] * (y + grid->count[1] * z);
}

// Returns the trilinear weight of a corner.
static inline float olx_cage_weight(const olx_cage *cage, uint32_t corner) {
  float weight = 1.0f;
  for (uint32_t axis = 0; axis < 3; axis++) {
    if (cage->corner_mask >> axis & 1u) weight *= corner >> axis & 1u ? cage->alpha[axis] : 1.0f - cage->alpha[axis];
  }
  return weight;
}

#endif
