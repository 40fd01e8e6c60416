// Encodes the images and maps of a report for the page's script.
#include "html_report.h"

#include "report.h"

#include <math.h>
#include <stdlib.h>

typedef struct map_scale {
  double low, high;
  bool logarithmic;
} map_scale;

cJSON *html_report_frame(cJSON *section, const char *name, const olx_image *image) {
  cJSON *frame = html_report_append(section, "frames");
  add_text(frame, "name", name);
  add_number(frame, "width", image->width);
  add_number(frame, "height", image->height);
  return frame;
}

void html_report_fact(cJSON *frame, const char *name, double value) {
  cJSON *fact = html_report_append(frame, "facts");
  add_text(fact, "name", name);
  add_number(fact, "value", value);
}

// Rounds to a half float with the last three bits of its mantissa zero: the error is below 1 %, and the file is two
// thirds as large.
static uint16_t short_half(float value) {
  const uint16_t sign = value < 0.0f ? 0x8000 : 0;
  const float magnitude = fabsf(value);
  if (isnan(value)) return 0x7e00;
  if (magnitude >= 65280.0f) return sign | 0x7bf8;
  if (magnitude < 0x1p-14f) return sign | (uint16_t)lroundf(magnitude * 0x1p24f);
  int exponent;
  const float mantissa = frexpf(magnitude, &exponent); // 0.5 to 1; rounding up carries into the exponent
  return sign | (uint16_t)(((exponent + 14) << 10) + ((int)lroundf(mantissa * 256.0f) - 128) * 8);
}

static olx_result add_png(cJSON *frame, cJSON *item, uint32_t channels, uint32_t height, const uint8_t *pixels) {
  const uint32_t width = (uint32_t)cJSON_GetObjectItem(frame, "width")->valuedouble;
  uint8_t *png;
  size_t size_bytes;
  const olx_result result = olx_png_encode(width, height, channels, pixels, &png, &size_bytes);
  if (result != OLX_OK) return result;
  const bool added = cJSON_AddItemToObject(item, "png", html_report_bytes(png, size_bytes)) != 0;
  olx_png_free(png);
  return added ? OLX_OK : OLX_ERROR_MEMORY;
}

static void put_half(uint8_t *high, uint8_t *low, float value) {
  const uint16_t half = short_half(value);
  *high = (uint8_t)(half >> 8);
  *low = (uint8_t)half;
}

// Encodes an image as a PNG of twice the height: the high bytes above, the low bytes below.
olx_result html_report_picture(cJSON *frame, const char *name, const olx_image *image, olx_layer layer,
                               float exposure) {
  cJSON *picture = html_report_append(frame, "pictures");
  add_text(picture, "name", name);
  add_number(picture, "exposure", (double)exposure);
  const size_t pixels = (size_t)image->width * image->height;
  uint8_t *bytes = malloc(6 * pixels);
  if (!bytes) return OLX_ERROR_MEMORY;
  for (size_t i = 0; i < pixels; ++i) {
    const olx_vec3 light = image->layers[layer][i];
    const bool gray = layer == OLX_LAYER_DEPTH;
    const float channels[3] = {light.x, gray ? light.x : light.y, gray ? light.x : light.z};
    for (size_t k = 0; k < 3; ++k) put_half(bytes + 3 * i + k, bytes + 3 * (pixels + i) + k, channels[k] * exposure);
  }
  const olx_result result = add_png(frame, picture, 3, 2 * image->height, bytes);
  free(bytes);
  return result;
}

// Adds a map of values, quantized from `low` to `high` in equal steps or in equal ratios.
static olx_result add_map(cJSON *frame, const char *name, const float *values, map_scale scale) {
  cJSON *map = html_report_append(frame, "maps");
  add_text(map, "name", name);
  add_number(map, "low", scale.low);
  add_number(map, "high", scale.high);
  cJSON_AddBoolToObject(map, "logarithmic", scale.logarithmic);
  const uint32_t height = (uint32_t)cJSON_GetObjectItem(frame, "height")->valuedouble;
  const size_t pixels = (size_t)cJSON_GetObjectItem(frame, "width")->valuedouble * height;
  uint8_t *bytes = malloc(pixels);
  if (!bytes) return OLX_ERROR_MEMORY;
  for (size_t i = 0; i < pixels; ++i) bytes[i] = (uint8_t)(255.0f * fminf(fmaxf(values[i], 0.0f), 1.0f) + 0.5f);
  const olx_result result = add_png(frame, map, 1, height, bytes);
  free(bytes);
  return result;
}

olx_result html_report_flip(cJSON *frame, const char *name, const float *flip_map) {
  return add_map(frame, name, flip_map, (map_scale){0.0, 1.0, false});
}

static double square_of_difference(olx_vec3 a, olx_vec3 b, bool gray) {
  const double x = (double)a.x - (double)b.x, y = (double)a.y - (double)b.y, z = (double)a.z - (double)b.z;
  return gray ? x * x : (x * x + y * y + z * z) / 3.0;
}

olx_result html_report_squares(cJSON *frame, const char *name, const olx_image *image, const olx_image *reference,
                               olx_layer layer) {
  const map_scale scale = {1e-6, 1.0, true};
  const olx_vec3 *a = image->layers[layer], *b = reference->layers[layer];
  const size_t pixels = (size_t)image->width * image->height;
  const bool gray = layer == OLX_LAYER_DEPTH;
  double sum = 0.0;
  for (size_t i = 0; i < pixels; ++i) {
    const double square = square_of_difference(b[i], (olx_vec3){0.0f, 0.0f, 0.0f}, gray);
    if (isfinite(square)) sum += square;
  }
  const double mean_square = sum > 0.0 ? sum / (double)pixels : 1.0;
  float *map = malloc(pixels * sizeof *map);
  if (!map) return OLX_ERROR_MEMORY;
  for (size_t i = 0; i < pixels; ++i) {
    const double error = square_of_difference(a[i], b[i], gray) / mean_square; // NaN where depth is infinite
    map[i] = error > 0.0 ? (float)(log10(error / scale.low) / log10(scale.high / scale.low)) : 0.0f;
  }
  const olx_result result = add_map(frame, name, map, scale);
  free(map);
  return result;
}

void html_report_maps_of(cJSON *frame, int count, const char *picture) {
  cJSON *maps = cJSON_GetObjectItem(frame, "maps");
  const int all = cJSON_GetArraySize(maps);
  for (int i = all - count; i < all; ++i) add_text(cJSON_GetArrayItem(maps, i), "of", picture);
}
