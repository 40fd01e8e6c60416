// From octahedral maps to spherical harmonics: the coefficients that come closest to a map's texels in the
// least-squares sense, each texel weighing what its solid angle is. What is in the bands itself comes back exactly, on
// maps of any size.
#ifndef OLX_BAKE_PROJECTION_H
#define OLX_BAKE_PROJECTION_H

#include "core/harmonics.h"

#include <octalux/base.h>

typedef struct olx_projection {
  uint32_t bands, texels;
  float *shares; // of a texel in each coefficient
} olx_projection;

// For maps of size x size texels without border, row by row.
olx_result olx_projection_create(uint32_t bands, uint32_t size, olx_projection *projection);
void olx_projection_free(olx_projection *projection);
void olx_project(const olx_projection *projection, const olx_vec3 *map, olx_vec3 *coefficients);

#endif
