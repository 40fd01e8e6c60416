// Corrections of irradiance maps: smooth in direction, a few cells per probe, added to the maps so that interpolation
// between probes approximates, in the least-squares sense, the irradiance measured at surface points (docs/baking.md).
// A bake solves for them once per bounce; a relighter continues from frame to frame.
#ifndef OLX_BAKE_CORRECTIONS_H
#define OLX_BAKE_CORRECTIONS_H

#include "core/octahedral.h"

#include <octalux/base.h>

enum { OLX_CORRECTION_SIDE = 8, OLX_CORRECTION_CELLS = OLX_CORRECTION_SIDE * OLX_CORRECTION_SIDE };

// The four cells around a position in a map, and their bilinear weights.
typedef struct olx_correction_cells {
  uint16_t cell[4];
  float weight[4];
} olx_correction_cells;

olx_correction_cells olx_correction_cells_at(olx_vec2 uv);

// The probes that are interpolated at a point, and the cells around its normal.
typedef struct olx_correction_taps {
  uint32_t count;
  const uint32_t *probes;
  const float *weights;
  const olx_correction_cells *cells;
} olx_correction_taps;

// Evaluates corrections, OLX_CORRECTION_CELLS per probe, at a point.
olx_vec3 olx_corrections_predict(const olx_vec3 *corrections, const olx_correction_taps *taps);
// Adds a point's value to the unknowns that it depends on: the transpose of olx_corrections_predict.
void olx_corrections_scatter(olx_vec3 *unknowns, const olx_correction_taps *taps, olx_vec3 value);
// Evaluates one probe's correction at a position in its map.
olx_vec3 olx_correction_at(const olx_vec3 *cells, olx_vec2 uv);

// The state of conjugate gradients on the normal equations, separate for each colour channel. The caller fills
// `gradient` (the right side minus the matrix times `solution`), and before each step `product` (the matrix times
// `direction`).
typedef struct olx_corrections {
  size_t unknowns; // OLX_CORRECTION_CELLS per probe for corrections of maps
  olx_vec3 *solution, *gradient, *direction, *product;
  double norm[3];
} olx_corrections;

// Allocates memory for that many unknowns, olx_corrections_bytes of it; the solution begins as 0. Returns false when
// memory runs out; olx_corrections_free is called even then.
size_t olx_corrections_bytes(size_t unknowns);
bool olx_corrections_allocate(olx_corrections *c, size_t unknowns);
void olx_corrections_free(olx_corrections *c);

// Adds to `product` the penalties on size and on differences between neighbouring cells, applied to `x`; `strength` is
// the mean number of points that a probe contributes to.
void olx_corrections_penalize(const olx_corrections *c, const olx_vec3 *x, float strength, olx_vec3 *product);
void olx_corrections_begin(olx_corrections *c);
void olx_corrections_step(olx_corrections *c);

#endif
