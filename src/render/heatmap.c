// Draws the differences between an image and its reference, |a - b| over the reference's mean, with a colour scale.
#include "render/image_io.h"

#include "core/hooks.h"
#include "core/result.h"
#include "core/vec.h"

#include <math.h>
#include <string.h>

#define BAR_WIDTH 12
#define BAR_GAP 6
#define DIGIT_WIDTH 5
#define DIGIT_HEIGHT 7
#define DIGIT_PITCH (DIGIT_WIDTH + 1)
#define STRIP_WIDTH (2 * BAR_GAP + BAR_WIDTH + 5 * DIGIT_PITCH + BAR_GAP)

typedef struct picture {
  uint32_t width, height;
  uint8_t *rgb;
} picture;

// Rows of 5 bits, leftmost highest: the ten digits, then the percent sign.
static const uint8_t glyphs[11][DIGIT_HEIGHT] = {
    {0x0e, 0x11, 0x13, 0x15, 0x19, 0x11, 0x0e}, {0x04, 0x0c, 0x04, 0x04, 0x04, 0x04, 0x0e},
    {0x0e, 0x11, 0x01, 0x02, 0x04, 0x08, 0x1f}, {0x0e, 0x11, 0x01, 0x06, 0x01, 0x11, 0x0e},
    {0x02, 0x06, 0x0a, 0x12, 0x1f, 0x02, 0x02}, {0x1f, 0x10, 0x1e, 0x01, 0x01, 0x11, 0x0e},
    {0x06, 0x08, 0x10, 0x1e, 0x11, 0x11, 0x0e}, {0x1f, 0x01, 0x02, 0x04, 0x04, 0x04, 0x04},
    {0x0e, 0x11, 0x11, 0x0e, 0x11, 0x11, 0x0e}, {0x0e, 0x11, 0x11, 0x0f, 0x01, 0x02, 0x0c},
    {0x18, 0x19, 0x02, 0x04, 0x08, 0x13, 0x03},
};

static void put(const picture *target, uint32_t x, uint32_t y, const uint8_t color[3]) {
  if (x < target->width && y < target->height) memcpy(target->rgb + 3 * ((size_t)y * target->width + x), color, 3);
}

static void draw_glyph(const picture *target, uint32_t x, uint32_t y, uint32_t glyph) {
  const uint8_t white[3] = {235, 235, 235};
  for (uint32_t row = 0; row < DIGIT_HEIGHT; ++row) {
    for (uint32_t column = 0; column < DIGIT_WIDTH; ++column) {
      if (glyphs[glyph][row] >> (DIGIT_WIDTH - 1 - column) & 1) put(target, x + column, y + row, white);
    }
  }
}

static void draw_percent(const picture *target, uint32_t x, uint32_t y, uint32_t percent) {
  if (percent >= 100) draw_glyph(target, x, y, percent / 100 % 10);
  if (percent >= 10) draw_glyph(target, x + DIGIT_PITCH, y, percent / 10 % 10);
  draw_glyph(target, x + 2 * DIGIT_PITCH, y, percent % 10);
  draw_glyph(target, x + 3 * DIGIT_PITCH, y, 10);
}

// Colours the error from black over violet, red and orange to yellow by its square root, so that small errors are
// visible.
static void error_color(double error, uint8_t color[3]) {
  static const double stops[5][3] = {{0, 0, 0}, {80, 18, 123}, {200, 40, 60}, {250, 140, 20}, {255, 245, 120}};
  const double position = 4.0 * fmin(sqrt(error), 1.0);
  const int stop = position < 3.0 ? (int)position : 3;
  for (int i = 0; i < 3; ++i) {
    const double value = stops[stop][i] + (stops[stop + 1][i] - stops[stop][i]) * (position - stop);
    color[i] = (uint8_t)(value + 0.5);
  }
}

static void draw_scale(const picture *target, uint32_t x) {
  static const uint32_t marks[] = {0, 1, 5, 10, 25, 50, 100};
  const uint32_t bottom = target->height - 1;
  for (uint32_t y = 0; y < target->height; ++y) {
    const double root = bottom ? (double)(bottom - y) / bottom : 1.0;
    uint8_t color[3];
    error_color(root * root, color);
    for (uint32_t i = 0; i < BAR_WIDTH; ++i) put(target, x + i, y, color);
  }
  if (target->height < DIGIT_HEIGHT) return;
  uint32_t free_above = target->height; // labels must not overlap in a low image
  for (size_t i = 0; i < sizeof marks / sizeof marks[0]; ++i) {
    const uint32_t middle = bottom - (uint32_t)(sqrt(marks[i] / 100.0) * bottom);
    const uint32_t centred = middle > DIGIT_HEIGHT / 2 ? middle - DIGIT_HEIGHT / 2 : 0;
    const uint32_t top = centred + DIGIT_HEIGHT > target->height ? target->height - DIGIT_HEIGHT : centred;
    if (i > 0 && top + DIGIT_HEIGHT + 1 > free_above) continue;
    draw_percent(target, x + BAR_WIDTH + BAR_GAP, top, marks[i]);
    free_above = top;
  }
}

static double magnitude(olx_vec3 v, uint32_t channels) {
  const double x = fabs((double)v.x), y = fabs((double)v.y), z = fabs((double)v.z);
  return channels == 1 ? x : (x + y + z) / 3.0;
}

// Returns the mean of the reference over its finite pixels; 1 for a black reference, so that errors are shown unscaled.
static double mean_of(const olx_image *image, olx_layer layer) {
  const size_t count = (size_t)image->width * image->height;
  double sum = 0.0;
  size_t finite = 0;
  for (size_t i = 0; i < count; ++i) {
    const double value = magnitude(image->layers[layer][i], olx_layer_channels(layer));
    if (!isfinite(value)) continue;
    sum += value;
    ++finite;
  }
  return sum > 0.0 ? sum / (double)finite : 1.0;
}

static void draw_errors(const picture *target, const olx_image *a, const olx_image *b, olx_layer layer) {
  const uint32_t channels = olx_layer_channels(layer);
  const double mean = mean_of(b, layer);
  for (uint32_t y = 0; y < a->height; ++y) {
    for (uint32_t x = 0; x < a->width; ++x) {
      const size_t i = (size_t)y * a->width + x;
      const double difference = magnitude(olx_sub(a->layers[layer][i], b->layers[layer][i]), channels);
      uint8_t color[3];
      error_color(isnan(difference) ? 0.0 : difference / mean, color); // NaN: both are infinite
      put(target, x, y, color);
    }
  }
}

olx_result olx_compare_heatmap(const olx_image *a, const olx_image *b, olx_layer layer, const char *path) {
  OLX_TRY(olx_compare_check(a, b, layer));
  picture target = {.width = a->width + STRIP_WIDTH, .height = a->height};
  target.rgb = olx_allocate_zero((size_t)target.width * target.height, 3);
  if (!target.rgb) return olx_fail(OLX_ERROR_MEMORY, "%s: no memory for %ux%u pixels", path, a->width, a->height);
  draw_errors(&target, a, b, layer);
  draw_scale(&target, a->width + BAR_GAP);
  const olx_result result = olx_png_write(path, target.width, target.height, target.rgb);
  olx_release(target.rgb);
  return result;
}
