// Image files behind olx_image_save and olx_image_load, and helpers that image writers share.
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

// The content of an EXR file to be written. Channels may come in any order.
typedef struct olx_exr_picture {
  uint32_t width, height;
  const olx_exr_channel *channels;
  uint32_t channel_count;
  const int32_t *bounces; // attribute "octaluxBounces"; NULL: unknown
} olx_exr_picture;

// Writes 32-bit float channels: one part, scanlines, ZIP. The file is written beside its path, synced and renamed.
olx_result olx_exr_write(const olx_exr_picture *picture, const char *path);
// Saves or loads an image as OpenEXR: every layer that exists, by the names of its channels.
olx_result olx_exr_save(const olx_image *image, const char *path);
olx_result olx_exr_load(const char *path, olx_image *image);

// Writes 8-bit RGB, rows from the top, 3 * width bytes per row. The file is written beside its path, synced and
// renamed.
olx_result olx_png_write(const char *path, uint32_t width, uint32_t height, const uint8_t *rgb);

// Maps linear radiance to sRGB bytes. Each channel is unchanged up to 0.6 and then approaches 1 by an exponential
// shoulder of the same slope, 0.6 + 0.4 (1 - exp(-(x - 0.6) / 0.4)), and is encoded by the sRGB transfer function. NaN
// becomes magenta.
void olx_tone_map(olx_vec3 radiance, float exposure, uint8_t rgb[3]);

// Returns whether an image has a layer; false for values outside the enumeration.
bool olx_image_has(const olx_image *image, olx_layer layer);

// Returns the number of channels with data in a layer: 1 for depth, otherwise 3.
uint32_t olx_layer_channels(olx_layer layer);

// Checks that two images can be compared over a layer: that sizes agree and every pixel is finite (or, for depth,
// infinite in both).
olx_result olx_compare_check(const olx_image *a, const olx_image *b, olx_layer layer);

#endif
