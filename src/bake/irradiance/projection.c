// Projects octahedral maps onto spherical harmonics by least squares: inverts the Gram matrix of the functions over the
// texels once, and applies the inverse to every map.
#include "bake/irradiance/projection.h"

#include "core/hooks.h"
#include "core/octahedral.h"
#include "core/result.h"

typedef struct gram {
  uint32_t count;
  double entry[OLX_HARMONICS_MOST][OLX_HARMONICS_MOST];
} gram;

// Returns the Gram matrix of the functions over the sphere, summed over the texels.
static gram gram_of(uint32_t count, uint32_t size) {
  gram g = {.count = count};
  for (uint32_t t = 0; t < size * size; t++) {
    float values[OLX_HARMONICS_MOST];
    olx_harmonics_at(olx_texel_direction(t % size, t / size, size), values);
    const double weight = olx_texel_solid_angle(t % size, t / size, size);
    for (uint32_t i = 0; i < count; i++) {
      for (uint32_t j = 0; j < count; j++) g.entry[i][j] += weight * (double)values[i] * (double)values[j];
    }
  }
  return g;
}

// Cholesky factorization in place, in the lower half.
static void factorize(gram *g) {
  for (uint32_t j = 0; j < g->count; j++) {
    for (uint32_t k = 0; k < j; k++) g->entry[j][j] -= g->entry[j][k] * g->entry[j][k];
    g->entry[j][j] = sqrt(g->entry[j][j]);
    for (uint32_t i = j + 1; i < g->count; i++) {
      for (uint32_t k = 0; k < j; k++) g->entry[i][j] -= g->entry[i][k] * g->entry[j][k];
      g->entry[i][j] /= g->entry[j][j];
    }
  }
}

static void solve(const gram *g, double x[OLX_HARMONICS_MOST]) {
  for (uint32_t i = 0; i < g->count; i++) {
    for (uint32_t k = 0; k < i; k++) x[i] -= g->entry[i][k] * x[k];
    x[i] /= g->entry[i][i];
  }
  for (uint32_t i = g->count; i-- > 0;) {
    for (uint32_t k = i + 1; k < g->count; k++) x[i] -= g->entry[k][i] * x[k];
    x[i] /= g->entry[i][i];
  }
}

olx_result olx_projection_create(uint32_t bands, uint32_t size, olx_projection *projection) {
  const uint32_t count = olx_harmonics_count(bands);
  *projection = (olx_projection){.bands = bands, .texels = size * size};
  projection->shares = olx_allocate((size_t)size * size * count, sizeof *projection->shares);
  if (!projection->shares) return olx_fail(OLX_ERROR_MEMORY, "bake: out of memory for spherical harmonics");
  gram g = gram_of(count, size);
  factorize(&g);
  for (uint32_t t = 0; t < projection->texels; t++) {
    float values[OLX_HARMONICS_MOST];
    double x[OLX_HARMONICS_MOST];
    olx_harmonics_at(olx_texel_direction(t % size, t / size, size), values);
    const double weight = olx_texel_solid_angle(t % size, t / size, size);
    for (uint32_t i = 0; i < count; i++) x[i] = weight * (double)values[i];
    solve(&g, x);
    for (uint32_t i = 0; i < count; i++) projection->shares[(size_t)t * count + i] = (float)x[i];
  }
  return OLX_OK;
}

void olx_projection_free(olx_projection *projection) {
  olx_release(projection->shares);
  *projection = (olx_projection){0};
}

void olx_project(const olx_projection *projection, const olx_vec3 *map, olx_vec3 *coefficients) {
  const uint32_t count = olx_harmonics_count(projection->bands);
  for (uint32_t i = 0; i < count; i++) {
    double sum[3] = {0.0};
    for (uint32_t t = 0; t < projection->texels; t++) {
      const double share = (double)projection->shares[(size_t)t * count + i];
      sum[0] += share * (double)map[t].x;
      sum[1] += share * (double)map[t].y;
      sum[2] += share * (double)map[t].z;
    }
    coefficients[i] = olx_v3((float)sum[0], (float)sum[1], (float)sum[2]);
  }
}
