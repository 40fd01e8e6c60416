// Finds pictures that are all white or all black at their exposure, as those of models with light in other units are.
#include "exposure.h"

#include "options.h"

#include <math.h>
#include <stdlib.h>

#define MIDDLE_GREY 0.18f
#define WHITE 3.0f             // tone-mapped to 255
#define BLACK (1.0f / 1024.0f) // tone-mapped to 3

static int by_size(const void *a, const void *b) {
  const float x = *(const float *)a, y = *(const float *)b;
  return (x > y) - (x < y);
}

// Returns the median luminance of the pixels that have any; 0 where none has.
static float median_light(const olx_image *image) {
  const olx_vec3 *pixels = image->layers[OLX_LAYER_BEAUTY];
  const size_t count = (size_t)image->width * image->height;
  float *light = malloc(count * sizeof *light), median = 0.0f;
  size_t lit = 0;
  if (!light) return 0.0f;
  for (size_t i = 0; i < count; i++) {
    const float luminance = 0.2126f * pixels[i].x + 0.7152f * pixels[i].y + 0.0722f * pixels[i].z;
    if (luminance > 0.0f && luminance < INFINITY) light[lit++] = luminance;
  }
  qsort(light, lit, sizeof *light, by_size);
  if (lit) median = light[lit / 2];
  free(light);
  return median;
}

void warn_about_exposure(const char *path, const olx_image *image, float exposure) {
  const float median = median_light(image);
  if (!(median > 0.0f) || (median * exposure < WHITE && median * exposure > BLACK)) return;
  warn("%s: most of the picture is %s: --exposure %.1g shows it", path, median * exposure > BLACK ? "white" : "black",
       (double)(MIDDLE_GREY / median));
}
