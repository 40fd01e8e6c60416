// Loads its input as OBJ and MTL for coverage-guided fuzzing: the input holds the model, a byte of 0, and square.mtl,
// which the model may refer to.
#include "harness.h"

#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size_bytes) {
  uint8_t tga[34];
  fuzz_begin();
  const uint8_t *end = size_bytes ? memchr(data, 0, size_bytes) : NULL;
  const size_t model_bytes = end ? (size_t)(end - data) : size_bytes;
  scene_folder_write(fuzz_folder(), "four.tga", tga, scene_files_tga(tga));
  scene_folder_write(fuzz_folder(), "square.mtl", end ? end + 1 : data, end ? size_bytes - model_bytes - 1 : 0);
  fuzz_scene(scene_folder_write(fuzz_folder(), "input.obj", data, model_bytes));
  fuzz_end(size_bytes, FUZZ_SCENE_FACTOR);
  return 0;
}
