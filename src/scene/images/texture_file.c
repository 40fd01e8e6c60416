// Decodes image files into textures and environments, and reads an image's size from its header alone, so that limits
// apply before anything is decoded.
#include "scene/images/texture_file.h"

#include "core/file.h"
#include "core/hooks.h"
#include "core/result.h"
#include "scene/images/environment_file.h"
#include "scene/images/exr_file.h"
#include "scene/images/hdr_check.h"
#include "scene/images/jpeg_check.h"
#include "scene/images/png_check.h"
#include "scene/images/webp_file.h"
#include "scene/import/import_limits.h"

#include <limits.h>
#include <string.h>

enum {
  LONGEST_SIDE = 16384,
  FEW_TEXELS = 1 << 22 // an image of one colour and so many texels takes some tens of bytes as WebP
};

static void *resize_memory(void *memory, size_t old_bytes, size_t new_bytes) {
  void *resized = olx_allocate(new_bytes, 1);
  if (!resized) return NULL;
  if (memory) memcpy(resized, memory, old_bytes < new_bytes ? old_bytes : new_bytes);
  olx_release(memory);
  return resized;
}

#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_JPEG
#define STBI_ONLY_PNG
#define STBI_ONLY_TGA
#define STBI_ONLY_BMP
#define STBI_ONLY_HDR
#define STBI_NO_STDIO
#define STBI_MAX_DIMENSIONS (1 << 24) // images with sides above LONGEST_SIDE are rejected here, with a clearer message
#define STBI_MALLOC(size_bytes) olx_allocate_zero((size_bytes), 1) // zeroed: damaged images leave texels unset
#define STBI_REALLOC_SIZED(memory, old_bytes, new_bytes) resize_memory((memory), (old_bytes), (new_bytes))
#define STBI_FREE(memory) olx_release(memory)
#pragma GCC diagnostic ignored "-Wunused-function" // reported at the end of the file, so that it cannot be popped
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wpedantic"
#pragma GCC diagnostic ignored "-Wundef"
#include <stb/stb_image.h>
#pragma GCC diagnostic pop

// Reads the size from a PNG's header, where stb_image returns none for images that it cannot decode.
static void read_png_size(const void *data, size_t size_bytes, int *width, int *height) {
  const uint8_t *b = data;
  if (size_bytes < 24 || memcmp(b, "\x89PNG\r\n\x1a\n", 8) != 0 || memcmp(b + 12, "IHDR", 4) != 0) return;
  const uint32_t sides[2] = {(uint32_t)b[16] << 24 | (uint32_t)b[17] << 16 | (uint32_t)b[18] << 8 | b[19],
                             (uint32_t)b[20] << 24 | (uint32_t)b[21] << 16 | (uint32_t)b[22] << 8 | b[23]};
  *width = sides[0] < INT_MAX ? (int)sides[0] : INT_MAX;
  *height = sides[1] < INT_MAX ? (int)sides[1] : INT_MAX;
}

static olx_result read_size(const char *path, const void *data, size_t size_bytes, int *width, int *height) {
  int channels;
  if (size_bytes > INT_MAX) return olx_fail(OLX_ERROR_UNSUPPORTED, "%s: an image of more than 2 GiB", path);
  if (olx_is_webp(data, size_bytes)) return olx_webp_size(path, data, size_bytes, width, height);
  OLX_TRY(olx_jpeg_check(path, data, size_bytes));
  const bool known = stbi_info_from_memory(data, (int)size_bytes, width, height, &channels);
  if (!known) read_png_size(data, size_bytes, width, height);
  if (known || *width > LONGEST_SIDE || *height > LONGEST_SIDE) return OLX_OK;
  return olx_fail(OLX_ERROR_FORMAT, "%s: not an image that can be read (%s)", path, stbi_failure_reason());
}

// Rejects headers that claim more texels per byte than a compressed image can hold.
static olx_result check_header(const char *path, const void *data, size_t size_bytes, uint64_t *texels) {
  int width = 0, height = 0;
  OLX_TRY(read_size(path, data, size_bytes, &width, &height));
  if (width > LONGEST_SIDE || height > LONGEST_SIDE) {
    return olx_fail(OLX_ERROR_UNSUPPORTED, "%s: an image of %d x %d texels, of which a side can have %d at most", path,
                    width, height, LONGEST_SIDE);
  }
  *texels = (uint64_t)width * (uint64_t)height;
  const bool few = olx_is_webp(data, size_bytes) && *texels <= FEW_TEXELS;
  if (width < 1 || height < 1 || (!few && *texels / 16384 > size_bytes)) {
    return olx_fail(OLX_ERROR_FORMAT, "%s: the header says %d x %d texels, which %zu bytes cannot hold", path, width,
                    height, size_bytes);
  }
  return OLX_OK;
}

static void alpha_to_red(olx_texture *texture) {
  const size_t count = (size_t)texture->width * texture->height;
  bool varies = false;
  for (size_t i = 0; i < count && !varies; ++i) varies = texture->texels[i * 4 + 3] != 255;
  for (size_t i = 0; i < count && varies; ++i) texture->texels[i * 4] = texture->texels[i * 4 + 3];
}

static void make_opaque(olx_texture *texture) {
  const size_t count = (size_t)texture->width * texture->height;
  for (size_t i = 0; i < count; ++i) texture->texels[i * 4 + 3] = 255;
}

static olx_result decode_texels(const char *path, const void *data, size_t size_bytes, int *width, int *height,
                                uint8_t **texels) {
  int channels;
  if (olx_is_webp(data, size_bytes)) {
    OLX_TRY(olx_webp_size(path, data, size_bytes, width, height));
    return olx_webp_decode(path, data, size_bytes, *width, *height, texels);
  }
  OLX_TRY(olx_png_check(path, data, size_bytes));
  OLX_TRY(olx_hdr_check(path, data, size_bytes));
  *texels = stbi_load_from_memory(data, (int)size_bytes, width, height, &channels, 4);
  if (*texels) return OLX_OK;
  return olx_fail(OLX_ERROR_FORMAT, "%s: cannot decode the image (%s)", path, stbi_failure_reason());
}

static olx_result decode_texture(const char *path, const void *data, size_t size_bytes, olx_texture_use use,
                                 olx_texture *texture) {
  uint64_t count;
  int width = 0, height = 0;
  uint8_t *texels = NULL;
  OLX_TRY(check_header(path, data, size_bytes, &count));
  OLX_TRY(decode_texels(path, data, size_bytes, &width, &height, &texels));
  *texture = (olx_texture){.width = (uint32_t)width,
                           .height = (uint32_t)height,
                           .texels = texels,
                           .srgb = use == OLX_TEXTURE_COLOR || use == OLX_TEXTURE_OPAQUE};
  if (use == OLX_TEXTURE_COVERAGE) alpha_to_red(texture);
  if (use == OLX_TEXTURE_OPAQUE) make_opaque(texture);
  return OLX_OK;
}

olx_result olx_texture_load(const char *path, const void *data, size_t size_bytes, olx_texture_use use,
                            olx_texture *texture) {
  if (data) return decode_texture(path, data, size_bytes, use, texture);
  olx_mapped_file file;
  OLX_TRY(olx_map_file(path, &file));
  const olx_result result = file.size_bytes ? decode_texture(path, file.data, file.size_bytes, use, texture)
                                            : olx_fail(OLX_ERROR_FORMAT, "%s: the file is empty", path);
  olx_unmap_file(&file);
  return result;
}

olx_result olx_texture_measure(const char *path, const void *data, size_t size_bytes, uint64_t *texels) {
  if (data) return check_header(path, data, size_bytes, texels);
  olx_mapped_file file;
  OLX_TRY(olx_map_file(path, &file));
  const olx_result result = file.size_bytes ? check_header(path, file.data, file.size_bytes, texels)
                                            : olx_fail(OLX_ERROR_FORMAT, "%s: the file is empty", path);
  olx_unmap_file(&file);
  return result;
}

static olx_result decode_environment(const char *path, const olx_mapped_file *file, const olx_scene *scene,
                                     olx_environment *environment) {
  uint64_t count;
  if (olx_is_exr(file->data, file->size_bytes)) return olx_environment_read_exr(path, scene, environment);
  OLX_TRY(check_header(path, file->data, file->size_bytes, &count));
  OLX_TRY(olx_import_check_limit(scene, OLX_LIMIT_TEXELS, olx_scene_texels(scene) + count, path, "environment"));
  if (!stbi_is_hdr_from_memory(file->data, (int)file->size_bytes)) {
    return olx_fail(OLX_ERROR_UNSUPPORTED, "%s: an environment must be a Radiance .hdr or an OpenEXR image", path);
  }
  OLX_TRY(olx_hdr_check(path, file->data, file->size_bytes));
  int width = 0, height = 0, channels = 0;
  float *texels = stbi_loadf_from_memory(file->data, (int)file->size_bytes, &width, &height, &channels, 3);
  if (!texels) return olx_fail(OLX_ERROR_FORMAT, "%s: cannot decode the image (%s)", path, stbi_failure_reason());
  environment->width = (uint32_t)width;
  environment->height = (uint32_t)height;
  environment->texels = texels;
  return OLX_OK;
}

olx_result olx_environment_load(const char *path, const olx_scene *scene, olx_environment *environment,
                                uint64_t *repaired) {
  olx_mapped_file file;
  OLX_TRY(olx_map_file(path, &file));
  const olx_result result = file.size_bytes ? decode_environment(path, &file, scene, environment)
                                            : olx_fail(OLX_ERROR_FORMAT, "%s: the file is empty", path);
  olx_unmap_file(&file);
  if (result != OLX_OK) return result;
  *repaired = 0;
  for (size_t i = 0; i < (size_t)environment->width * environment->height * 3; ++i) {
    if (environment->texels[i] >= 0.0f && isfinite(environment->texels[i])) continue;
    environment->texels[i] = 0.0f;
    ++*repaired;
  }
  return OLX_OK;
}
