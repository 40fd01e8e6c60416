// Corrections of irradiance maps: smooth in direction, a few cells a probe, added to the maps so that interpolation
// between probes comes closest, in the least-squares sense, to irradiance measured at points on surfaces
// (docs/baking.md). A bake solves for them once a bounce, a relighter goes on from frame to frame.
#ifndef OLX_BAKE_CORRECTIONS_H
#define OLX_BAKE_CORRECTIONS_H

#include "core/octahedral.h"

#include <octalux/base.h>

enum { OLX_CORRECTION_SIDE = 8, OLX_CORRECTION_CELLS = OLX_CORRECTION_SIDE * OLX_CORRECTION_SIDE };

// The cells around a place of a map, and their bilinear weights.
typedef struct olx_correction_cells {
  uint16_t cell[4];
  float weight[4];
} olx_correction_cells;

olx_correction_cells olx_correction_cells_at(olx_vec2 uv);

// The probes that answer for a point, and the cells around its normal.
typedef struct olx_correction_taps {
  uint32_t count;
  const uint32_t *probes;
  const float *weights;
  const olx_correction_cells *cells;
} olx_correction_taps;

// What corrections, OLX_CORRECTION_CELLS a probe, add at a point.
olx_vec3 olx_corrections_predict(const olx_vec3 *corrections, const olx_correction_taps *taps);
// Add a point's value to the unknowns that it depends on: the transpose of predict.
void olx_corrections_scatter(olx_vec3 *unknowns, const olx_correction_taps *taps, olx_vec3 value);
// One probe's correction at a place of its map.
olx_vec3 olx_correction_at(const olx_vec3 *cells, olx_vec2 uv);

// Conjugate gradients on the normal equations, each colour channel on its own. The caller fills `gradient` (the right
// side less the product with `solution`), and before each step `product`, that with `direction`.
typedef struct olx_corrections {
  size_t unknowns; // OLX_CORRECTION_CELLS a probe where maps are corrected
  olx_vec3 *solution, *gradient, *direction, *product;
  double norm[3];
} olx_corrections;

// Memory for that many unknowns, olx_corrections_bytes of it; solution is 0. False when there is none;
// olx_corrections_free then too.
size_t olx_corrections_bytes(size_t unknowns);
bool olx_corrections_allocate(olx_corrections *c, size_t unknowns);
void olx_corrections_free(olx_corrections *c);

// Add to `product` what the penalties on size and on differences between neighbouring cells make of `x`; `strength` is
// the number of points that a probe answers for on average.
void olx_corrections_penalize(const olx_corrections *c, const olx_vec3 *x, float strength, olx_vec3 *product);
void olx_corrections_begin(olx_corrections *c);
void olx_corrections_step(olx_corrections *c);

#endif
