// Loads its input as a cooked scene, for coverage-guided fuzzing.
#include "harness.h"

#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size_bytes) {
  fuzz_begin();
  uint8_t *bytes = fuzz_copy(data, size_bytes);
  fuzz_scene(scene_folder_write(fuzz_folder(), "input.olxs", bytes, size_bytes));
  free(bytes);
  fuzz_end(size_bytes, FUZZ_SCENE_FACTOR);
  return 0;
}
