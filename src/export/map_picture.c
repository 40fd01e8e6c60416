// Writes maps of probes as .exr images in a chosen projection.
#include "core/hooks.h"
#include "core/octahedral.h"
#include "core/result.h"
#include "export/map_texels.h"
#include "field/field_data.h"
#include "render/image_io.h"

#include <stdio.h>

enum { MOST_SIZE = 2048, FACES = 6 };

const char *olx_map_projection_name(olx_map_projection projection) {
  static const char *const names[] = {"octahedral", "latlong", "cube"};
  return (size_t)projection < sizeof names / sizeof *names ? names[projection] : "unknown";
}

typedef struct map_image {
  uint32_t width, height, size;
  olx_map_projection projection;
} map_image;

// Returns the direction of a point: u and v from 0 to 1 across and down the whole image.
static olx_vec3 latlong_direction(float u, float v) {
  const float around = (u - 0.5f) * 2.0f * OLX_PI, down = v * OLX_PI;
  return olx_v3(sinf(down) * cosf(around), cosf(down), sinf(down) * sinf(around));
}

// Returns the direction of a point: a and b from -1 to 1 across and down a face.
static olx_vec3 cube_direction(uint32_t face, float a, float b) {
  const olx_vec3 directions[FACES] = {{1.0f, -b, -a}, {-1.0f, -b, a}, {a, 1.0f, b},
                                      {a, -1.0f, -b}, {a, -b, 1.0f},  {-a, -b, -1.0f}};
  return directions[face];
}

static olx_vec3 pixel_direction(const map_image *image, uint32_t x, uint32_t y) {
  const float size = (float)image->size;
  if (image->projection == OLX_PROJECTION_LATLONG) {
    return latlong_direction(((float)x + 0.5f) / (2.0f * size), ((float)y + 0.5f) / size);
  }
  return cube_direction(y / image->size, 2.0f * ((float)x + 0.5f) / size - 1.0f,
                        2.0f * ((float)(y % image->size) + 0.5f) / size - 1.0f);
}

static uint32_t texel_of(float coordinate, uint32_t side) {
  const uint32_t texel = (uint32_t)(coordinate * (float)side);
  return texel < side ? texel : side - 1;
}

static void fill(const olx_field *field, const olx_map_picture *picture, const map_image *image, olx_vec3 *pixels) {
  const uint32_t side = olx_map_side(field, picture->map);
  for (uint32_t y = 0; y < image->height; y++) {
    for (uint32_t x = 0; x < image->width; x++) {
      uint32_t column = x, row = y;
      if (image->projection != OLX_PROJECTION_OCTAHEDRAL) {
        const olx_vec2 uv = olx_octahedral_encode(pixel_direction(image, x, y));
        column = texel_of(uv.x, side);
        row = texel_of(uv.y, side);
      }
      pixels[x + (size_t)image->width * y] = olx_map_texel(field, picture->map, picture->probe, column, row);
    }
  }
}

static olx_result write_pixels(const olx_map_picture *picture, const map_image *image, const olx_vec3 *pixels,
                               const char *path) {
  const uint32_t count = olx_map_channels(picture->map);
  olx_exr_channel channels[3];
  for (uint32_t i = 0; i < count; i++) {
    channels[i] = (olx_exr_channel){.values = &pixels->x + i, .stride_floats = 3};
    snprintf(channels[i].name, sizeof channels[i].name, "%c", count == 1 ? 'Y' : "RGB"[i]);
  }
  const olx_exr_picture exr = {
      .width = image->width, .height = image->height, .channels = channels, .channel_count = count};
  return olx_exr_write(&exr, path);
}

static olx_result choose_image(const olx_field *field, const olx_map_picture *picture, map_image *image) {
  OLX_TRY(olx_map_check(field, picture->map, picture->probe));
  const uint32_t side = olx_map_side(field, picture->map);
  const bool cube = picture->projection == OLX_PROJECTION_CUBE;
  if (picture->projection > OLX_PROJECTION_CUBE || picture->size > MOST_SIZE) {
    return olx_fail(OLX_ERROR_ARGUMENT, "projection %u, size %u: not one of the projections, or a size above %d",
                    (uint32_t)picture->projection, picture->size, MOST_SIZE);
  }
  if (picture->projection == OLX_PROJECTION_OCTAHEDRAL) {
    if (picture->size && picture->size != side) {
      return olx_fail(OLX_ERROR_ARGUMENT, "a size of %u: an octahedral picture has that of its map, %u", picture->size,
                      side);
    }
    *image = (map_image){.width = side, .height = side, .size = side, .projection = picture->projection};
    return OLX_OK;
  }
  const uint32_t size = picture->size ? picture->size : cube ? side / 2 : side;
  *image = (map_image){.width = cube ? size : 2 * size,
                       .height = cube ? FACES * size : size,
                       .size = size,
                       .projection = picture->projection};
  return OLX_OK;
}

olx_result olx_export_map(const olx_field *field, const olx_map_picture *picture, const char *path, uint32_t *width,
                          uint32_t *height) {
  map_image image = {0};
  OLX_TRY(choose_image(field, picture, &image));
  olx_vec3 *pixels = olx_allocate((size_t)image.width * image.height, sizeof *pixels);
  if (!pixels) return olx_fail(OLX_ERROR_MEMORY, "%s: out of memory", path);
  fill(field, picture, &image, pixels);
  const olx_result result = write_pixels(picture, &image, pixels, path);
  olx_release(pixels);
  if (width) *width = image.width;
  if (height) *height = image.height;
  return result;
}
