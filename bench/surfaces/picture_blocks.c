// Compares the indirect diffuse light of two pictures in blocks of 8 x 8 pixels.
#include "picture_blocks.h"

#include <math.h>

// Blocks of pixels darker than this share of the image's mean are ignored, because noise dominates there.
static const double DARK = 0.01;

// Blocks with light in fewer pixels of the reference are ignored. They show slivers of surfaces, like the edge of a
// window's bar before the sky, which the few camera samples of the field's picture may miss altogether.
enum { BLOCK = 8, LEAST_LIT = BLOCK * BLOCK / 4 };

static double light_of(const olx_image *image, uint32_t x, uint32_t y) {
  const olx_vec3 light = image->layers[OLX_LAYER_INDIRECT_DIFFUSE][(size_t)y * image->width + x];
  return (double)light.x + (double)light.y + (double)light.z;
}

double surface_block_light(const olx_image *image, uint32_t left, uint32_t top, uint32_t side) {
  double sum = 0.0;
  for (uint32_t i = 0; i < side * side; ++i) sum += light_of(image, left + i % side, top + i / side);
  return sum / (side * side);
}

double surface_mean_light(const olx_image *image) {
  double sum = 0.0;
  for (uint32_t y = 0; y < image->height; ++y) {
    for (uint32_t x = 0; x < image->width; ++x) sum += light_of(image, x, y);
  }
  return sum / ((double)image->width * image->height);
}

// Returns whether enough pixels of the block hold light.
static bool is_lit(const olx_image *image, uint32_t left, uint32_t top) {
  uint32_t lit = 0;
  for (uint32_t i = 0; i < BLOCK * BLOCK; ++i) lit += light_of(image, left + i % BLOCK, top + i / BLOCK) > 0.0;
  return lit >= LEAST_LIT;
}

void surface_compare_blocks(const olx_image *image, const olx_image *reference, double *least, double *most) {
  const double dark = DARK * surface_mean_light(reference);
  *least = *most = 1.0;
  for (uint32_t top = 0; top + BLOCK <= image->height; top += BLOCK) {
    for (uint32_t left = 0; left + BLOCK <= image->width; left += BLOCK) {
      const double truth = surface_block_light(reference, left, top, BLOCK);
      if (truth <= dark || !is_lit(reference, left, top)) continue;
      const double ratio = surface_block_light(image, left, top, BLOCK) / truth;
      *least = fmin(*least, ratio);
      *most = fmax(*most, ratio);
    }
  }
}
