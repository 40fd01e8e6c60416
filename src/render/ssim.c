// Computes the mean structural similarity of two images (Wang et al. 2004) over Gaussian windows, separated into rows
// and columns.
#include "render/perceptual.h"

#include "core/hooks.h"
#include "core/result.h"

#include <math.h>
#include <string.h>

#define RADIUS 5
#define WINDOW (2 * RADIUS + 1)

// Weighted sums over a window: of both images, their squares and their product.
typedef struct moments {
  double a, b, aa, bb, ab;
} moments;

static void add_scaled(moments *sum, double weight, const moments *m) {
  sum->a += weight * m->a;
  sum->b += weight * m->b;
  sum->aa += weight * m->aa;
  sum->bb += weight * m->bb;
  sum->ab += weight * m->ab;
}

static void window_weights(double weights[WINDOW]) {
  double sum = 0.0;
  for (int i = 0; i < WINDOW; ++i) sum += weights[i] = exp(-(i - RADIUS) * (i - RADIUS) / (2.0 * 1.5 * 1.5));
  for (int i = 0; i < WINDOW; ++i) weights[i] /= sum;
}

static double luma(const uint8_t *rgb) { return (0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2]) / 255.0; }

// Returns the similarity of a window, equation 13.
static double similarity(const moments *m) {
  const double c1 = 0.01 * 0.01, c2 = 0.03 * 0.03;
  const double variance_a = m->aa - m->a * m->a, variance_b = m->bb - m->b * m->b, covariance = m->ab - m->a * m->b;
  return (2.0 * m->a * m->b + c1) * (2.0 * covariance + c2) /
         ((m->a * m->a + m->b * m->b + c1) * (variance_a + variance_b + c2));
}

// Sums the windows whose first row is `top`: along the columns into `columns`, then along the row.
static double sum_row(const uint8_t *a, const uint8_t *b, uint32_t width, uint32_t top, const double weights[WINDOW],
                      moments *columns) {
  memset(columns, 0, width * sizeof *columns);
  for (uint32_t i = 0; i < WINDOW; ++i) {
    const size_t row = (size_t)(top + i) * width;
    for (uint32_t x = 0; x < width; ++x) {
      const double p = luma(a + 3 * (row + x)), q = luma(b + 3 * (row + x));
      add_scaled(&columns[x], weights[i], &(moments){p, q, p * p, q * q, p * q});
    }
  }
  double sum = 0.0;
  for (uint32_t x = 0; x + WINDOW <= width; ++x) {
    moments window = {0};
    for (uint32_t i = 0; i < WINDOW; ++i) add_scaled(&window, weights[i], &columns[x + i]);
    sum += similarity(&window);
  }
  return sum;
}

olx_result olx_ssim(const uint8_t *a, const uint8_t *b, uint32_t width, uint32_t height, double *ssim) {
  *ssim = NAN;
  if (width < WINDOW || height < WINDOW) return OLX_OK;
  double weights[WINDOW];
  window_weights(weights);
  moments *columns = olx_allocate(width, sizeof *columns);
  if (!columns) return olx_fail(OLX_ERROR_MEMORY, "no memory to compare %u pixels", width);
  double sum = 0.0;
  for (uint32_t top = 0; top + WINDOW <= height; ++top) sum += sum_row(a, b, width, top, weights, columns);
  olx_release(columns);
  *ssim = sum / ((double)(width - WINDOW + 1) * (height - WINDOW + 1));
  return OLX_OK;
}
