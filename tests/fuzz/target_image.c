// Loads its input as a texture (JPEG, PNG, WebP, TGA, BMP), as an environment (HDR, EXR), and as a picture for `compare`
// (EXR), for coverage-guided fuzzing.
#include "harness.h"
#include "sound_scene.h"

#include "core/hooks.h"
#include "scene/images/texture_file.h"

#include <octalux/render.h>

#include <math.h>

static void read_texture(const uint8_t *data, size_t size_bytes, olx_texture_use use) {
  olx_texture texture = {0};
  uint64_t texels = 0;
  const olx_result measured = olx_texture_measure("image", data, size_bytes, &texels);
  if (olx_texture_load("image", data, size_bytes, use, &texture) != OLX_OK) return;
  sound_scene_demand(measured == OLX_OK && texels == (uint64_t)texture.width * texture.height, "the size of a texture");
  olx_release(texture.texels);
}

static void read_environment(const char *path) {
  const olx_scene scene = {.load = {.limits = {.texels = 1 << 24}}};
  olx_environment environment = {0};
  uint64_t repaired;
  if (olx_environment_load(path, &scene, &environment, &repaired) != OLX_OK) return;
  const size_t count = 3 * (size_t)environment.width * environment.height;
  for (size_t i = 0; i < count; i++) {
    sound_scene_demand(isfinite(environment.texels[i]) && environment.texels[i] >= 0.0f, "a texel");
  }
  olx_release(environment.texels);
}

static void read_image(const char *path) {
  olx_image image;
  if (olx_image_load(path, &image) == OLX_OK) olx_image_free(&image);
  else sound_scene_demand(olx_last_error()[0], "a refusal without a message");
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size_bytes) {
  fuzz_begin();
  const char *path = scene_folder_write(fuzz_folder(), "input.image", data, size_bytes);
  if (size_bytes) read_texture(data, size_bytes, (olx_texture_use)(size_bytes % (OLX_TEXTURE_COVERAGE + 1)));
  read_environment(path);
  read_image(path);
  fuzz_end(size_bytes, (size_t)1 << 20);
  return 0;
}
