// Solves for smooth corrections of irradiance maps by conjugate gradients on the normal equations, with penalties on
// their size and on their slope over directions.
#include "bake/irradiance/corrections.h"

#include "core/hooks.h"

#include <string.h>

// Weights of the penalties on a correction's size and on its differences between neighbouring directions, relative to
// the mean number of surface points that a probe contributes to.
static const float SIZE_PENALTY = 1e-4f;
static const float SMOOTHNESS_PENALTY = 3e-4f;

olx_correction_cells olx_correction_cells_at(olx_vec2 uv) {
  const float x = uv.x * OLX_CORRECTION_SIDE - 0.5f, y = uv.y * OLX_CORRECTION_SIDE - 0.5f;
  const int32_t x0 = (int32_t)floorf(x), y0 = (int32_t)floorf(y);
  const float fx = x - (float)x0, fy = y - (float)y0;
  olx_correction_cells cells;
  for (int32_t k = 0; k < 4; k++) {
    int32_t sx, sy;
    olx_border_source(x0 + (k & 1), y0 + (k >> 1), OLX_CORRECTION_SIDE, &sx, &sy);
    cells.cell[k] = (uint16_t)(sy * OLX_CORRECTION_SIDE + sx);
    cells.weight[k] = (k & 1 ? fx : 1.0f - fx) * (k >> 1 ? fy : 1.0f - fy);
  }
  return cells;
}

olx_vec3 olx_corrections_predict(const olx_vec3 *corrections, const olx_correction_taps *taps) {
  olx_vec3 sum = {0};
  for (uint32_t k = 0; k < taps->count; k++) {
    const olx_vec3 *cells = corrections + (size_t)taps->probes[k] * OLX_CORRECTION_CELLS;
    for (uint32_t i = 0; i < 4; i++) {
      sum = olx_madd(sum, cells[taps->cells->cell[i]], taps->weights[k] * taps->cells->weight[i]);
    }
  }
  return sum;
}

void olx_corrections_scatter(olx_vec3 *unknowns, const olx_correction_taps *taps, olx_vec3 value) {
  for (uint32_t k = 0; k < taps->count; k++) {
    olx_vec3 *cells = unknowns + (size_t)taps->probes[k] * OLX_CORRECTION_CELLS;
    for (uint32_t i = 0; i < 4; i++) {
      olx_vec3 *cell = &cells[taps->cells->cell[i]];
      *cell = olx_madd(*cell, value, taps->weights[k] * taps->cells->weight[i]);
    }
  }
}

olx_vec3 olx_correction_at(const olx_vec3 *cells, olx_vec2 uv) {
  const olx_correction_cells around = olx_correction_cells_at(uv);
  olx_vec3 sum = {0};
  for (uint32_t k = 0; k < 4; k++) sum = olx_madd(sum, cells[around.cell[k]], around.weight[k]);
  return sum;
}

size_t olx_corrections_bytes(size_t unknowns) { return 4 * unknowns * sizeof(olx_vec3); }

bool olx_corrections_allocate(olx_corrections *c, size_t unknowns) {
  *c = (olx_corrections){
      .unknowns = unknowns,
      .solution = olx_allocate_zero(unknowns, sizeof(olx_vec3)),
      .gradient = olx_allocate(unknowns, sizeof(olx_vec3)),
      .direction = olx_allocate(unknowns, sizeof(olx_vec3)),
      .product = olx_allocate(unknowns, sizeof(olx_vec3)),
  };
  return c->solution && c->gradient && c->direction && c->product;
}

void olx_corrections_free(olx_corrections *c) {
  olx_release(c->solution);
  olx_release(c->gradient);
  olx_release(c->direction);
  olx_release(c->product);
  *c = (olx_corrections){0};
}

static void penalize(const olx_vec3 *x, float strength, olx_vec3 *product) {
  for (int32_t cy = 0; cy < OLX_CORRECTION_SIDE; cy++) {
    for (int32_t cx = 0; cx < OLX_CORRECTION_SIDE; cx++) {
      const size_t c = (size_t)(cy * OLX_CORRECTION_SIDE + cx);
      product[c] = olx_madd(product[c], x[c], SIZE_PENALTY * strength);
      for (int32_t axis = 0; axis < 2; axis++) {
        int32_t sx, sy;
        olx_border_source(cx + (axis == 0), cy + (axis == 1), OLX_CORRECTION_SIDE, &sx, &sy);
        const size_t next = (size_t)(sy * OLX_CORRECTION_SIDE + sx);
        const olx_vec3 step = olx_scale(olx_sub(x[c], x[next]), SMOOTHNESS_PENALTY * strength);
        product[c] = olx_add(product[c], step);
        product[next] = olx_sub(product[next], step);
      }
    }
  }
}

void olx_corrections_penalize(const olx_corrections *c, const olx_vec3 *x, float strength, olx_vec3 *product) {
  for (size_t first = 0; first < c->unknowns; first += OLX_CORRECTION_CELLS) {
    penalize(x + first, strength, product + first);
  }
}

static void dot_each(const olx_vec3 *a, const olx_vec3 *b, size_t count, double sum[3]) {
  sum[0] = sum[1] = sum[2] = 0.0;
  for (size_t i = 0; i < count; i++) {
    sum[0] += (double)a[i].x * (double)b[i].x;
    sum[1] += (double)a[i].y * (double)b[i].y;
    sum[2] += (double)a[i].z * (double)b[i].z;
  }
}

static float ratio(double a, double b) { return b > 0.0 ? (float)(a / b) : 0.0f; }

static olx_vec3 ratios(const double a[3], const double b[3]) {
  return olx_v3(ratio(a[0], b[0]), ratio(a[1], b[1]), ratio(a[2], b[2]));
}

void olx_corrections_begin(olx_corrections *c) {
  memcpy(c->direction, c->gradient, c->unknowns * sizeof *c->direction);
  dot_each(c->gradient, c->gradient, c->unknowns, c->norm);
}

void olx_corrections_step(olx_corrections *c) {
  double steepness[3], norm[3];
  dot_each(c->direction, c->product, c->unknowns, steepness);
  const olx_vec3 length = ratios(c->norm, steepness);
  for (size_t i = 0; i < c->unknowns; i++) {
    c->solution[i] = olx_add(c->solution[i], olx_mul(length, c->direction[i]));
    c->gradient[i] = olx_sub(c->gradient[i], olx_mul(length, c->product[i]));
  }
  dot_each(c->gradient, c->gradient, c->unknowns, norm);
  const olx_vec3 keep = ratios(norm, c->norm);
  memcpy(c->norm, norm, sizeof norm);
  for (size_t i = 0; i < c->unknowns; i++) {
    c->direction[i] = olx_add(c->gradient[i], olx_mul(keep, c->direction[i]));
  }
}
