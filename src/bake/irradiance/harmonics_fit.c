// Fits spherical harmonics to irradiance measured on surfaces: corrects the coefficients of each probe until what the
// runtime interpolates comes closest to the measurements.
#include "bake/irradiance/harmonics_fit.h"

#include "core/harmonics.h"
#include "core/result.h"

#include <string.h>

enum { STEPS = 48 }; // of conjugate gradients

// Weights of two penalties, relative to the number of points that a probe contributes to: on the mean square of a
// correction over directions, and on the mean square of its slope. They are the penalties on one cell of a map's
// correction, summed over the cells of the sphere.
static const float SIZE_PENALTY = 1e-4f * OLX_CORRECTION_CELLS;
static const float SMOOTHNESS_PENALTY = 3e-4f * 4.0f * OLX_PI;

typedef struct harmonics_fit {
  const olx_surface_fit *fit;
  uint32_t count, point_count; // number of coefficients per probe, and of points
  olx_corrections corrections;
} harmonics_fit;

static olx_vec3 predict(const harmonics_fit *h, const olx_vec3 *x, const olx_irradiance_weights *w,
                        const float *values) {
  olx_vec3 sum = {0};
  for (uint32_t k = 0; k < w->count; k++) {
    const olx_vec3 *probe = x + (size_t)w->probe[k] * h->count;
    for (uint32_t i = 0; i < h->count; i++) sum = olx_madd(sum, probe[i], w->weight[k] * values[i]);
  }
  return sum;
}

static void scatter(const harmonics_fit *h, olx_vec3 *x, const olx_irradiance_weights *w, const float *values,
                    olx_vec3 value) {
  for (uint32_t k = 0; k < w->count; k++) {
    olx_vec3 *probe = x + (size_t)w->probe[k] * h->count;
    for (uint32_t i = 0; i < h->count; i++) probe[i] = olx_madd(probe[i], value, w->weight[k] * values[i]);
  }
}

// Scatters the prediction of `x` at every point, or its difference from the measurements, back to the unknowns that it
// depends on.
static void accumulate(const harmonics_fit *h, const olx_vec3 *x, bool residual, olx_vec3 *unknowns) {
  memset(unknowns, 0, h->corrections.unknowns * sizeof *unknowns);
  for (uint32_t p = 0; p < h->point_count; p++) {
    olx_surface_measurement m;
    float values[OLX_HARMONICS_MOST];
    if (!olx_surface_fit_measurement(h->fit, p, &m)) continue;
    olx_harmonics_at(m.normal, values);
    const olx_vec3 made = predict(h, x, m.weights, values);
    scatter(h, unknowns, m.weights, values, residual ? olx_sub(m.irradiance, made) : made);
  }
}

static void penalize(const harmonics_fit *h, const olx_vec3 *x, olx_vec3 *product) {
  for (size_t u = 0; u < h->corrections.unknowns; u++) {
    const uint32_t index = (uint32_t)(u % h->count), band = index == 0 ? 0 : index < 4 ? 1 : 2;
    const float penalty = SIZE_PENALTY + SMOOTHNESS_PENALTY * (float)(band * (band + 1)); // -l (l + 1) is the
                                                                                          // eigenvalue of the Laplacian
    product[u] = olx_madd(product[u], x[u], penalty * OLX_FIT_POINTS_PER_PROBE * olx_harmonics_mean_square(index));
  }
}

olx_result olx_harmonics_fit(const olx_surface_fit *fit, uint32_t bands, olx_vec3 *coefficients, uint32_t probe_count) {
  harmonics_fit h = {
      .fit = fit, .count = olx_harmonics_count(bands), .point_count = probe_count * OLX_FIT_POINTS_PER_PROBE};
  olx_corrections *c = &h.corrections;
  if (!olx_corrections_allocate(c, (size_t)probe_count * h.count)) {
    olx_corrections_free(c);
    return olx_fail(OLX_ERROR_MEMORY, "bake: out of memory for fitting %u irradiance probes", probe_count);
  }
  accumulate(&h, coefficients, true, c->gradient);
  olx_corrections_begin(c);
  for (uint32_t step = 0; step < STEPS; step++) {
    accumulate(&h, c->direction, false, c->product);
    penalize(&h, c->direction, c->product);
    olx_corrections_step(c);
  }
  for (size_t u = 0; u < c->unknowns; u++) coefficients[u] = olx_add(coefficients[u], c->solution[u]);
  olx_corrections_free(c);
  return OLX_OK;
}
