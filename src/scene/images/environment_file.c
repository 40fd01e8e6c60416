// Reads an environment from the channels R, G and B of an OpenEXR image, and ignores other channels and layers; half
// floats are converted to floats.
#include "scene/images/environment_file.h"

#include "core/hooks.h"
#include "core/result.h"
#include "scene/images/exr_file.h"
#include "scene/import/import_limits.h"

#include <string.h>

// Returns the index of channel R, G or B; 3 for others.
static uint32_t component_of(const char *channel) {
  static const char *const names[] = {"R", "G", "B"};
  uint32_t i = 0;
  while (i < 3 && strcmp(channel, names[i]) != 0) ++i;
  return i;
}

static bool note_component(void *user, const char *channel) {
  const uint32_t component = component_of(channel);
  if (component < 3) *(uint32_t *)user |= 1u << component;
  return component < 3;
}

static olx_exr_target find_target(void *user, const char *channel, uint32_t row) {
  const olx_environment *e = user;
  const uint32_t component = component_of(channel);
  if (component == 3) return (olx_exr_target){.pixels = NULL};
  return (olx_exr_target){.pixels = e->texels + (size_t)row * e->width * 3 + component,
                          .pixel_bytes = 3 * sizeof(float),
                          .line_bytes = (int32_t)(e->width * 3 * sizeof(float))};
}

// Limits the size, because a few hundred bytes can claim gigabytes (texture_file.c).
static olx_result check_size(const olx_exr_file *file, const olx_scene *scene) {
  const uint64_t texels = (uint64_t)file->width * file->height;
  OLX_TRY(olx_import_check_limit(scene, OLX_LIMIT_TEXELS, olx_scene_texels(scene) + texels, file->path, "environment"));
  if (texels / 16384 <= file->mapped.size_bytes) return OLX_OK;
  return olx_fail(OLX_ERROR_FORMAT, "%s: the header says %u x %u texels, which %zu bytes cannot hold", file->path,
                  file->width, file->height, file->mapped.size_bytes);
}

static olx_result read_texels(olx_exr_file *file, const olx_scene *scene, olx_environment *environment) {
  uint32_t components = 0;
  OLX_TRY(olx_exr_find_channels(file, note_component, &components));
  if (components != 7) return olx_fail(OLX_ERROR_UNSUPPORTED, "%s: no channels R G B", file->path);
  OLX_TRY(check_size(file, scene));
  olx_environment read = {.width = file->width, .height = file->height};
  read.texels = olx_allocate((size_t)read.width * read.height, 3 * sizeof *read.texels);
  if (!read.texels) return olx_fail(OLX_ERROR_MEMORY, "%s: no memory for the image", file->path);
  const olx_result result = olx_exr_read(file, find_target, &read);
  if (result != OLX_OK) {
    olx_release(read.texels);
    return result;
  }
  environment->width = read.width;
  environment->height = read.height;
  environment->texels = read.texels;
  return OLX_OK;
}

olx_result olx_environment_read_exr(const char *path, const olx_scene *scene, olx_environment *environment) {
  olx_exr_file file;
  olx_result result = olx_exr_open(path, &file);
  if (result == OLX_OK) result = read_texels(&file, scene, environment);
  olx_exr_close(&file);
  return result;
}
