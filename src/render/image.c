// Holds images of named layers, and loads and saves them as OpenEXR, or as PNG after tone mapping.
#include "render/image_io.h"

#include "core/hooks.h"
#include "core/result.h"

#include <math.h>
#include <string.h>

const char *olx_layer_name(olx_layer layer) {
  switch (layer) {
  case OLX_LAYER_BEAUTY: return "beauty";
  case OLX_LAYER_DIRECT: return "direct";
  case OLX_LAYER_INDIRECT_DIFFUSE: return "indirect_diffuse";
  case OLX_LAYER_INDIRECT_GLOSSY: return "indirect_glossy";
  case OLX_LAYER_ALBEDO: return "albedo";
  case OLX_LAYER_NORMAL: return "normal";
  case OLX_LAYER_DEPTH: return "depth";
  case OLX_LAYER_STANDARD_ERROR: return "standard_error";
  case OLX_LAYER_COUNT: break;
  }
  return "unknown layer";
}

uint32_t olx_layer_channels(olx_layer layer) { return layer == OLX_LAYER_DEPTH ? 1 : 3; }

bool olx_layer_is_color(olx_layer layer) {
  return layer < OLX_LAYER_COUNT && layer != OLX_LAYER_NORMAL && layer != OLX_LAYER_DEPTH;
}

bool olx_image_has(const olx_image *image, olx_layer layer) {
  return layer < OLX_LAYER_COUNT && image->layers[layer] != NULL;
}

olx_result olx_image_create(uint32_t width, uint32_t height, uint32_t layer_mask, olx_image *image) {
  *image = (olx_image){0};
  if (width < 1 || height < 1 || width > OLX_PICTURE_SIZE_MOST || height > OLX_PICTURE_SIZE_MOST) {
    return olx_fail(OLX_ERROR_ARGUMENT, "image size %ux%u: width and height must be 1 to %d", width, height,
                    OLX_PICTURE_SIZE_MOST);
  }
  image->width = width;
  image->height = height;
  for (uint32_t layer = 0; layer < OLX_LAYER_COUNT; ++layer) {
    if (!(layer_mask >> layer & 1)) continue;
    image->layers[layer] = olx_allocate_zero((size_t)width * height, sizeof(olx_vec3));
    if (!image->layers[layer]) {
      olx_image_free(image);
      return olx_fail(OLX_ERROR_MEMORY, "no memory for a layer of %ux%u pixels", width, height);
    }
  }
  return OLX_OK;
}

void olx_image_free(olx_image *image) {
  for (uint32_t layer = 0; layer < OLX_LAYER_COUNT; ++layer) olx_release(image->layers[layer]);
  *image = (olx_image){0};
}

static bool ends_with(const char *path, const char *ending) {
  const size_t length = strlen(path), ending_length = strlen(ending);
  return length > ending_length && strcmp(path + length - ending_length, ending) == 0;
}

olx_result olx_image_save(const olx_image *image, const char *path) {
  if (ends_with(path, ".exr")) return olx_exr_save(image, path);
  if (ends_with(path, ".png")) return olx_image_save_layer_png(image, OLX_LAYER_BEAUTY, 1.0f, path);
  return olx_fail(OLX_ERROR_ARGUMENT, "%s: an image's name must end in .exr or .png", path);
}

olx_result olx_image_load(const char *path, olx_image *image) {
  *image = (olx_image){0};
  return olx_exr_load(path, image);
}

static float shoulder(float x) {
  const float knee = 0.6f, rest = 1.0f - knee;
  if (x <= knee) return x > 0.0f ? x : 0.0f;
  return knee + rest * (1.0f - expf((knee - x) / rest));
}

static uint8_t srgb_byte(float linear) {
  const float encoded = linear <= 0.0031308f ? 12.92f * linear : 1.055f * powf(linear, 1.0f / 2.4f) - 0.055f;
  return (uint8_t)(255.0f * encoded + 0.5f);
}

void olx_tone_map(olx_vec3 radiance, float exposure, uint8_t rgb[3]) {
  const float channels[3] = {radiance.x * exposure, radiance.y * exposure, radiance.z * exposure};
  if (isnan(channels[0]) || isnan(channels[1]) || isnan(channels[2])) {
    rgb[0] = 255;
    rgb[1] = 0;
    rgb[2] = 255;
    return;
  }
  for (int i = 0; i < 3; ++i) rgb[i] = srgb_byte(shoulder(channels[i]));
}

olx_result olx_image_save_layer_png(const olx_image *image, olx_layer layer, float exposure, const char *path) {
  if (!olx_image_has(image, layer))
    return olx_fail(OLX_ERROR_ARGUMENT, "%s: the image has no layer %s", path, olx_layer_name(layer));
  if (!(exposure > 0.0f) || !isfinite(exposure)) {
    return olx_fail(OLX_ERROR_ARGUMENT, "%s: exposure %g is not a positive number", path, (double)exposure);
  }
  const olx_vec3 *pixels = image->layers[layer];
  const size_t count = (size_t)image->width * image->height;
  uint8_t *rgb = olx_allocate(count, 3);
  if (!rgb) return olx_fail(OLX_ERROR_MEMORY, "%s: no memory for %ux%u pixels", path, image->width, image->height);
  for (size_t i = 0; i < count; ++i) {
    const olx_vec3 pixel =
        olx_layer_channels(layer) == 1 ? (olx_vec3){pixels[i].x, pixels[i].x, pixels[i].x} : pixels[i];
    olx_tone_map(pixel, exposure, rgb + 3 * i);
  }
  const olx_result result = olx_png_write(path, image->width, image->height, rgb);
  olx_release(rgb);
  return result;
}
