// Compares images with their references, and writes them to the report and to files.
#include "experiment.h"
#include "html_report.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { PATH_TEXT = 4096 };

void bench_quality_cells(const bench_quality *q, bench_cell cells[BENCH_DIFFERENCE_COLUMNS]) {
  const double numbers[BENCH_DIFFERENCE_COLUMNS] = {q->error.mse,  q->error.noise, q->error.relative_mse,
                                                    q->error.bias, q->ssim,        q->flip};
  for (uint32_t c = 0; c < BENCH_DIFFERENCE_COLUMNS; ++c) cells[c] = NUMBER_CELL(numbers[c]);
}

static olx_layer layer_of(bench_light light) {
  static const olx_layer layers[] = {[BENCH_DIFFUSE] = OLX_LAYER_INDIRECT_DIFFUSE,
                                     [BENCH_GLOSSY] = OLX_LAYER_INDIRECT_GLOSSY,
                                     [BENCH_INDIRECT] = OLX_LAYER_BEAUTY,
                                     [BENCH_BEAUTY] = OLX_LAYER_BEAUTY};
  return layers[light];
}

// Returns the exposure, a power of two, at which a dim layer of indirect light is visible. Bright pixels count more
// than dark ones, because a layer may be black where nothing is glossy.
static float exposure_for(const olx_image *reference, olx_layer layer) {
  if (layer == OLX_LAYER_BEAUTY) return 1.0f;
  const size_t pixels = (size_t)reference->width * reference->height;
  double sum = 0.0, squares = 0.0;
  for (size_t i = 0; i < pixels; ++i) {
    const olx_vec3 light = reference->layers[layer][i];
    const double mean = ((double)light.x + (double)light.y + (double)light.z) / 3.0;
    sum += mean;
    squares += mean * mean;
  }
  return sum > 0.0 ? (float)exp2(fmin(fmax(rint(log2(0.4 * sum / squares)), 0.0), 16.0)) : 1.0f;
}

static olx_result look(bench *b, const olx_image *image, const olx_image *reference, olx_layer layer, float *flip_map,
                       float *exposure, olx_perceptual *perceptual) {
  if (!image || !reference) return OLX_ERROR_MEMORY;
  olx_perceptual_settings settings = olx_perceptual_settings_default();
  settings.exposure = *exposure = exposure_for(reference, layer);
  settings.threads = b->options->threads;
  return olx_compare_perceptual(image, reference, layer, &settings, flip_map, perceptual);
}

olx_result bench_compare(bench *b, bench_images *images, bench_images *references, bench_light light, uint32_t camera,
                         bench_quality *quality) {
  *quality = (bench_quality){.error = bench_error_of(images, references, light, camera), .ssim = NAN, .flip = NAN};
  if (light == BENCH_INDIRECT || camera == BENCH_CAMERAS) return OLX_OK;
  olx_perceptual perceptual;
  const olx_result result = look(b, bench_images_mean(images, camera), bench_images_mean(references, camera),
                                 layer_of(light), NULL, &quality->exposure, &perceptual);
  quality->ssim = perceptual.ssim;
  quality->flip = perceptual.flip;
  return result;
}

// Saves an image under a name such as "mcguire-leaks-fig-10-field-indirect_diffuse.png", with safe characters only.
static olx_result save_picture(const bench *b, const char *view, const char *way, const olx_image *image,
                               olx_layer layer, float exposure) {
  char path[PATH_TEXT];
  snprintf(path, sizeof path, "%s/%s-%s-%s-%s.png", b->options->images, b->experiment->name, view, way,
           olx_layer_name(layer));
  for (char *c = path + strlen(b->options->images) + 1; *c; ++c) {
    const bool plain = strchr("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_.", *c) != NULL;
    if (!plain) *c = '_';
  }
  return olx_image_save_layer_png(image, layer, exposure, path);
}

static olx_result add_way(bench *b, cJSON *frame, const bench_shown *way, const olx_image *reference, olx_layer layer) {
  const olx_image *image = bench_images_mean(way->images, way->camera);
  const size_t pixels = (size_t)reference->width * reference->height;
  float *flip_map = malloc(pixels * sizeof *flip_map), exposure;
  olx_perceptual perceptual;
  olx_result result = flip_map ? look(b, image, reference, layer, flip_map, &exposure, &perceptual) : OLX_ERROR_MEMORY;
  if (result == OLX_OK) result = html_report_picture(frame, way->way, image, layer, exposure);
  if (result == OLX_OK) result = html_report_flip(frame, "FLIP", flip_map);
  if (result == OLX_OK) result = html_report_squares(frame, "squared error", image, reference, layer);
  if (result == OLX_OK) html_report_maps_of(frame, 2, way->way);
  free(flip_map);
  return result;
}

static olx_result report_view(bench *b, const char *view, olx_layer layer, const bench_shown *ways, uint32_t count,
                              const olx_image *reference) {
  cJSON *frame = html_report_frame(b->section, view, reference);
  olx_result result = add_way(b, frame, &ways[0], reference, layer);
  // The divider separates the first two images.
  if (result == OLX_OK) {
    result = html_report_picture(frame, "path traced", reference, layer, exposure_for(reference, layer));
  }
  for (uint32_t i = 1; i < count && result == OLX_OK; ++i) result = add_way(b, frame, &ways[i], reference, layer);
  return result;
}

olx_result bench_show(bench *b, const char *view, olx_layer layer, const bench_shown *ways, uint32_t count,
                      bench_images *references, uint32_t reference_camera) {
  if (!b->section && !b->options->images) return OLX_OK;
  const olx_image *reference = bench_images_mean(references, reference_camera);
  if (!reference) return OLX_ERROR_MEMORY;
  olx_result result = b->section ? report_view(b, view, layer, ways, count, reference) : OLX_OK;
  if (!b->options->images) return result;
  const float exposure = exposure_for(reference, layer);
  for (uint32_t i = 0; i < count && result == OLX_OK; ++i) {
    const olx_image *image = bench_images_mean(ways[i].images, ways[i].camera);
    result = image ? save_picture(b, view, ways[i].way, image, layer, exposure) : OLX_ERROR_MEMORY;
  }
  return result == OLX_OK ? save_picture(b, view, "path", reference, layer, exposure) : result;
}
