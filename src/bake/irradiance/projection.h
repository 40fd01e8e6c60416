// Projects octahedral maps onto spherical harmonics by least squares over the texels, weighted by their solid angles. A
// function within the bands is recovered exactly, on maps of any size.
#ifndef OLX_BAKE_PROJECTION_H
#define OLX_BAKE_PROJECTION_H

#include "core/harmonics.h"

#include <octalux/base.h>

typedef struct olx_projection {
  uint32_t bands, texels;
  float *shares; // weight of each texel in each coefficient
} olx_projection;

// Prepares the projection of maps of size x size texels without border, row by row.
olx_result olx_projection_create(uint32_t bands, uint32_t size, olx_projection *projection);
void olx_projection_free(olx_projection *projection);
void olx_project(const olx_projection *projection, const olx_vec3 *map, olx_vec3 *coefficients);

#endif
