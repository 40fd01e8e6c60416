// Encodes images as PNG with dynamic Huffman codes, which halve the size of noisy images, and as JPEG.
#include "render/image_io.h"

#include "core/file.h"
#include "core/hooks.h"
#include "core/result.h"

#include <string.h>

#include <zlib.h>

enum { MOST_BYTES = 2000000000, MOST_JPEG_SIDE = 65535 }; // the latter by the format

// Compresses with dynamic Huffman codes: stb's own compressor has fixed codes only, which make noisy images twice as
// large.
static unsigned char *compress_bytes(unsigned char *data, int size_bytes, int *compressed_bytes, int quality) {
  uLongf length = compressBound((uLong)size_bytes);
  unsigned char *compressed = olx_allocate(length, 1);
  if (!compressed) return NULL;
  if (compress2(compressed, &length, data, (uLong)size_bytes, quality) != Z_OK) {
    olx_release(compressed);
    return NULL;
  }
  *compressed_bytes = (int)length;
  return compressed;
}

#define STBIW_ZLIB_COMPRESS compress_bytes
#define STBIW_MALLOC(size) olx_allocate((size_t)(size), 1)
#define STBIW_REALLOC(memory, size) NULL // stb requires the macro, but only its own compressor would use it
#define STBIW_FREE(memory) olx_release(memory)
#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_WRITE_IMPLEMENTATION
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#pragma GCC diagnostic ignored "-Wmissing-prototypes"
#pragma GCC diagnostic ignored "-Wpedantic"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wsign-compare"
#pragma GCC diagnostic ignored "-Wundef"
#include <stb/stb_image_write.h>
#pragma GCC diagnostic pop

// A picture must be small enough for stb's counts of bytes, which are ints, also after compression. A row of a PNG has
// a byte more than its pixels.
static olx_result check_picture(const char *format, uint32_t width, uint32_t height, uint32_t channels,
                                uint32_t most_side) {
  if (width < 1 || height < 1 || width > most_side || height > most_side ||
      (uint64_t)channels * width + 1 > MOST_BYTES / height) {
    return olx_fail(OLX_ERROR_ARGUMENT, "a %s cannot hold %ux%u pixels of %u channels", format, width, height,
                    channels);
  }
  return OLX_OK;
}

olx_result olx_png_encode(uint32_t width, uint32_t height, uint32_t channels, const uint8_t *pixels, uint8_t **png,
                          size_t *size_bytes) {
  *png = NULL;
  *size_bytes = 0;
  if (channels != 1 && channels != 3 && channels != 4) {
    return olx_fail(OLX_ERROR_ARGUMENT, "a PNG of %u channels: must be 1, 3 or 4", channels);
  }
  OLX_TRY(check_picture("PNG", width, height, channels, UINT32_MAX));
  int length = 0;
  *png = stbi_write_png_to_mem(pixels, (int)(channels * width), (int)width, (int)height, (int)channels, &length);
  *size_bytes = (size_t)length;
  return *png ? OLX_OK : olx_fail(OLX_ERROR_MEMORY, "no memory to compress %ux%u pixels", width, height);
}

void olx_png_free(uint8_t *png) { olx_release(png); }

typedef struct jpeg_bytes {
  uint8_t *data;
  size_t size_bytes, most_bytes;
  bool failed; // out of memory
} jpeg_bytes;

// Appends bytes of a JPEG to `context`, a jpeg_bytes.
static void append_bytes(void *context, void *data, int size_bytes) {
  jpeg_bytes *to = context;
  const size_t size = to->size_bytes + (size_t)size_bytes;
  if (size > to->most_bytes && !to->failed) {
    uint8_t *more = olx_allocate(2 * size, 1);
    if (more && to->size_bytes) memcpy(more, to->data, to->size_bytes);
    olx_release(to->data);
    to->data = more;
    to->most_bytes = 2 * size;
    to->failed = !more;
  }
  if (to->failed) return;
  memcpy(to->data + to->size_bytes, data, (size_t)size_bytes);
  to->size_bytes = size;
}

olx_result olx_jpeg_encode(uint32_t width, uint32_t height, uint32_t channels, const uint8_t *pixels, uint32_t quality,
                           uint8_t **jpeg, size_t *size_bytes) {
  *jpeg = NULL;
  *size_bytes = 0;
  if (channels != 3 && channels != 4) {
    return olx_fail(OLX_ERROR_ARGUMENT, "a JPEG of %u channels: must be 3 or 4", channels);
  }
  if (quality < 1 || quality > 100) {
    return olx_fail(OLX_ERROR_ARGUMENT, "a JPEG quality of %u is not within 1 to 100", quality);
  }
  OLX_TRY(check_picture("JPEG", width, height, channels, MOST_JPEG_SIDE));
  jpeg_bytes to = {.data = NULL};
  stbi_write_jpg_to_func(append_bytes, &to, (int)width, (int)height, (int)channels, pixels, (int)quality);
  *jpeg = to.data;
  *size_bytes = to.size_bytes;
  return to.data ? OLX_OK : olx_fail(OLX_ERROR_MEMORY, "no memory to compress %ux%u pixels", width, height);
}

olx_result olx_png_write(const char *path, uint32_t width, uint32_t height, const uint8_t *rgb) {
  uint8_t *png;
  size_t size_bytes;
  OLX_TRY(olx_png_encode(width, height, 3, rgb, &png, &size_bytes));
  const olx_result result = olx_write_file(path, png, size_bytes);
  olx_png_free(png);
  return result;
}
