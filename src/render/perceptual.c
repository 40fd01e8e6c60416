// Compares two images perceptually, by SSIM and FLIP of their tone-mapped pixels, and draws maps of FLIP.
#include "render/perceptual.h"

#include "core/hooks.h"
#include "core/result.h"
#include "render/image_io.h"

#include <math.h>

olx_perceptual_settings olx_perceptual_settings_default(void) {
  return (olx_perceptual_settings){.exposure = 1.0f, .pixels_per_degree = 67.0f};
}

static olx_result check(const olx_image *a, const olx_image *b, olx_layer layer,
                        const olx_perceptual_settings *settings) {
  OLX_TRY(olx_compare_check(a, b, layer));
  if (!olx_layer_is_color(layer)) {
    return olx_fail(OLX_ERROR_ARGUMENT, "layer %s is no picture to look at", olx_layer_name(layer));
  }
  if (!(settings->exposure > 0.0f) || !isfinite(settings->exposure)) {
    return olx_fail(OLX_ERROR_ARGUMENT, "exposure %g is not a positive number", (double)settings->exposure);
  }
  if (!(settings->pixels_per_degree > 0.0f) || settings->pixels_per_degree > OLX_FLIP_MAX_PIXELS_PER_DEGREE) {
    return olx_fail(OLX_ERROR_ARGUMENT, "%g pixels per degree: must be above 0 and at most %g",
                    (double)settings->pixels_per_degree, (double)OLX_FLIP_MAX_PIXELS_PER_DEGREE);
  }
  return OLX_OK;
}

static olx_result measure(const uint8_t *rgb, uint32_t width, uint32_t height, const olx_perceptual_settings *settings,
                          float *map, olx_perceptual *perceptual) {
  const size_t pixels = (size_t)width * height;
  const uint8_t *a = rgb, *b = rgb + 3 * pixels;
  OLX_TRY(olx_ssim(a, b, width, height, &perceptual->ssim));
  OLX_TRY(olx_flip(a, b, width, height, settings->pixels_per_degree, settings->threads, map));
  double sum = 0.0;
  for (size_t i = 0; i < pixels; ++i) sum += (double)map[i];
  perceptual->flip = sum / (double)pixels;
  return OLX_OK;
}

olx_result olx_compare_perceptual(const olx_image *a, const olx_image *b, olx_layer layer,
                                  const olx_perceptual_settings *settings, float *flip_map,
                                  olx_perceptual *perceptual) {
  *perceptual = (olx_perceptual){0};
  OLX_TRY(check(a, b, layer, settings));
  const size_t pixels = (size_t)a->width * a->height;
  uint8_t *rgb = olx_allocate(pixels, 6);
  float *map = flip_map ? flip_map : olx_allocate(pixels, sizeof *map);
  olx_result result = OLX_OK;
  if (!rgb || !map) {
    result = olx_fail(OLX_ERROR_MEMORY, "no memory to compare %ux%u pixels", a->width, a->height);
  } else {
    for (size_t i = 0; i < pixels; ++i) {
      olx_tone_map(a->layers[layer][i], settings->exposure, rgb + 3 * i);
      olx_tone_map(b->layers[layer][i], settings->exposure, rgb + 3 * (pixels + i));
    }
    result = measure(rgb, a->width, a->height, settings, map, perceptual);
  }
  if (map != flip_map) olx_release(map);
  olx_release(rgb);
  return result;
}

// Looks up the magma colour map of matplotlib, which is stored at 17 evenly spaced positions; linear interpolation
// differs from it by less than 3 / 255.
void olx_magma(float value, uint8_t rgb[3]) {
  static const uint8_t stops[17][3] = {
      {0, 0, 4},      {10, 8, 34},     {29, 17, 70},    {54, 16, 106},   {80, 18, 124},  {105, 28, 129},
      {130, 38, 129}, {156, 46, 127},  {182, 55, 121},  {207, 65, 112},  {230, 81, 99},  {245, 105, 92},
      {251, 135, 97}, {254, 165, 113}, {254, 195, 135}, {253, 224, 162}, {252, 253, 191}};
  const float position = value > 0.0f ? fminf(value, 1.0f) * 16.0f : 0.0f; // also 0 for NaN
  const int stop = position < 15.0f ? (int)position : 15;
  for (int i = 0; i < 3; ++i) {
    const float low = stops[stop][i], high = stops[stop + 1][i];
    rgb[i] = (uint8_t)(low + (high - low) * (position - (float)stop) + 0.5f);
  }
}

olx_result olx_flip_map_save(const float *flip_map, uint32_t width, uint32_t height, const char *path) {
  const size_t pixels = (size_t)width * height;
  uint8_t *rgb = olx_allocate(pixels, 3);
  if (!rgb) return olx_fail(OLX_ERROR_MEMORY, "%s: no memory for %ux%u pixels", path, width, height);
  for (size_t i = 0; i < pixels; ++i) olx_magma(flip_map[i], rgb + 3 * i);
  const olx_result result = olx_png_write(path, width, height, rgb);
  olx_release(rgb);
  return result;
}
