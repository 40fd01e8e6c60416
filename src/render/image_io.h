// Image files behind olx_image_save and olx_image_load, and what the pictures share.
#ifndef OLX_RENDER_IMAGE_IO_H
#define OLX_RENDER_IMAGE_IO_H

#include <octalux/limits.h>
#include <octalux/render.h>

// A channel of an EXR file. The value of pixel (x, y) is values[stride_floats * (x + width * y)].
typedef struct olx_exr_channel {
  char name[64];
  const float *values;
  uint32_t stride_floats;
} olx_exr_channel;

// What an EXR file is written from. Channels in any order.
typedef struct olx_exr_picture {
  uint32_t width, height;
  const olx_exr_channel *channels;
  uint32_t channel_count;
  const int32_t *bounces; // "octaluxBounces"; NULL: not known
} olx_exr_picture;

// 32-bit float channels, one part, scanlines, ZIP. Beside, synced, renamed.
olx_result olx_exr_write(const olx_exr_picture *picture, const char *path);
// Writes or reads an image as OpenEXR: every layer that is there, by the names of its channels.
olx_result olx_exr_save(const olx_image *image, const char *path);
olx_result olx_exr_load(const char *path, olx_image *image);

// 8-bit RGB, rows from the top, 3 * width bytes a row. Beside, synced, renamed.
olx_result olx_png_write(const char *path, uint32_t width, uint32_t height, const uint8_t *rgb);

// Linear radiance to sRGB bytes. Each channel is kept up to 0.6 and then eased into 1 by an exponential shoulder with
// the same slope, 0.6 + 0.4 (1 - exp(-(x - 0.6) / 0.4)), and encoded by the sRGB transfer function. Not a number is
// magenta.
void olx_tone_map(olx_vec3 radiance, float exposure, uint8_t rgb[3]);

// Whether an image has that layer. No image has a layer that the enumeration does not name.
bool olx_image_has(const olx_image *image, olx_layer layer);

// Channels of a layer that carry data: 1 for depth, else 3.
uint32_t olx_layer_channels(olx_layer layer);

// Whether two images can be compared over a layer, down to every pixel being finite (or, for depth, infinite in both).
olx_result olx_compare_check(const olx_image *a, const olx_image *b, olx_layer layer);

#endif
