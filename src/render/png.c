#include "render/image_io.h"

#include "core/file.h"
#include "core/hooks.h"
#include "core/result.h"

#include <string.h>

static void *reallocate(void *memory, size_t old_bytes, size_t new_bytes) {
  void *larger = olx_allocate(new_bytes, 1);
  if (larger && memory) memcpy(larger, memory, old_bytes < new_bytes ? old_bytes : new_bytes);
  if (larger) olx_release(memory);
  return larger;
}

#define STBIW_MALLOC(size) olx_allocate((size_t)(size), 1)
#define STBIW_REALLOC_SIZED(memory, old_bytes, new_bytes) reallocate(memory, (size_t)(old_bytes), (size_t)(new_bytes))
#define STBIW_REALLOC(memory, new_bytes) reallocate(memory, 0, (size_t)(new_bytes))
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

olx_result olx_png_write(const char *path, uint32_t width, uint32_t height, const uint8_t *rgb) {
  int size_bytes = 0;
  unsigned char *png = stbi_write_png_to_mem(rgb, (int)(3 * width), (int)width, (int)height, 3, &size_bytes);
  if (!png) return olx_fail(OLX_ERROR_MEMORY, "%s: no memory to compress %ux%u pixels", path, width, height);
  const olx_result result = olx_write_file(path, png, (size_t)size_bytes);
  olx_release(png);
  return result;
}
