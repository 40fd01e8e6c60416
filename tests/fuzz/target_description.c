// Loads its input as a scene's description, beside models and images that it may refer to, for coverage-guided fuzzing.
#include "harness.h"
#include "scene_seeds.h"

static void write_companions(void) {
  seed_file seeds[SEED_COUNT];
  scene_seeds_make(seeds);
  for (uint32_t i = 0; i < SEED_COUNT; i++) {
    scene_folder_write(fuzz_folder(), seeds[i].name, seeds[i].bytes, seeds[i].size_bytes);
  }
  scene_seeds_free(seeds);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size_bytes) {
  static bool written;
  fuzz_begin();
  if (!written) write_companions();
  written = true;
  fuzz_scene(scene_folder_write(fuzz_folder(), "input.json", data, size_bytes));
  fuzz_end(size_bytes, FUZZ_SCENE_FACTOR);
  return 0;
}
