// Compares a layer of two images: rejects values that are not finite, and computes mean squared error, bias and the
// largest difference, relative to the reference.
#include "render/image_io.h"

#include "core/result.h"

#include <math.h>

static float channel_of(olx_vec3 pixel, uint32_t channel) {
  return channel == 0 ? pixel.x : channel == 1 ? pixel.y : pixel.z;
}

static bool both_infinite(olx_layer layer, float a, float b) {
  return layer == OLX_LAYER_DEPTH && isinf(a) && isinf(b) && a > 0.0f && b > 0.0f;
}

olx_result olx_compare_check(const olx_image *a, const olx_image *b, olx_layer layer) {
  const char *name = olx_layer_name(layer);
  if (layer >= OLX_LAYER_COUNT) return olx_fail(OLX_ERROR_ARGUMENT, "there is no layer %d", (int)layer);
  if (a->width != b->width || a->height != b->height) {
    return olx_fail(OLX_ERROR_ARGUMENT, "sizes differ: the image has %ux%u pixels, the reference %ux%u", a->width,
                    a->height, b->width, b->height);
  }
  if (!olx_image_has(a, layer)) return olx_fail(OLX_ERROR_ARGUMENT, "the image has no layer %s", name);
  if (!olx_image_has(b, layer)) return olx_fail(OLX_ERROR_ARGUMENT, "the reference has no layer %s", name);
  const size_t count = (size_t)a->width * a->height;
  for (size_t i = 0; i < count; ++i) {
    for (uint32_t channel = 0; channel < olx_layer_channels(layer); ++channel) {
      const float x = channel_of(a->layers[layer][i], channel), y = channel_of(b->layers[layer][i], channel);
      if ((isfinite(x) && isfinite(y)) || both_infinite(layer, x, y)) continue;
      return olx_fail(OLX_ERROR_FORMAT, "layer %s, pixel (%zu, %zu) of the %s is %g: not a finite number", name,
                      i % a->width, i / a->width, isfinite(x) ? "reference" : "image", (double)(isfinite(x) ? y : x));
    }
  }
  return OLX_OK;
}

// Returns the difference relative to the reference: 0 when both are 0, infinite when only the reference is.
static double share(double difference, double reference) {
  return difference == 0.0 ? 0.0 : reference == 0.0 ? copysign(INFINITY, difference) : difference / reference;
}

olx_result olx_compare(const olx_image *a, const olx_image *b, olx_layer layer, olx_metrics *metrics) {
  *metrics = (olx_metrics){0};
  OLX_TRY(olx_compare_check(a, b, layer));
  const size_t count = (size_t)a->width * a->height;
  double square_difference = 0.0, square = 0.0, difference = 0.0, sum = 0.0, largest = 0.0, peak = 0.0;
  uint64_t values = 0;
  for (size_t i = 0; i < count; ++i) {
    for (uint32_t channel = 0; channel < olx_layer_channels(layer); ++channel) {
      const double x = (double)channel_of(a->layers[layer][i], channel);
      const double y = (double)channel_of(b->layers[layer][i], channel);
      if (isinf(x)) continue;
      values += 1;
      square_difference += (x - y) * (x - y);
      difference += x - y;
      square += y * y;
      sum += y;
      largest = fmax(largest, fabs(x - y));
      peak = fmax(peak, fabs(y));
    }
  }
  metrics->mse = values ? square_difference / (double)values : 0.0;
  metrics->relative_mse = share(square_difference, square);
  metrics->bias = share(difference, sum);
  metrics->psnr = metrics->mse == 0.0 ? INFINITY : 10.0 * log10(peak * peak / metrics->mse);
  metrics->max = largest;
  return OLX_OK;
}
