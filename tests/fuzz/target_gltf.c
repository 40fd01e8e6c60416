// Loads its input as glTF, as text and as .glb, beside an image that it may refer to, for coverage-guided fuzzing.
#include "harness.h"

#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size_bytes) {
  uint8_t tga[34];
  fuzz_begin();
  scene_folder_write(fuzz_folder(), "four.tga", tga, scene_files_tga(tga));
  const bool binary = size_bytes >= 4 && memcmp(data, "glTF", 4) == 0;
  fuzz_scene(scene_folder_write(fuzz_folder(), binary ? "input.glb" : "input.gltf", data, size_bytes));
  fuzz_end(size_bytes, FUZZ_SCENE_FACTOR);
  return 0;
}
