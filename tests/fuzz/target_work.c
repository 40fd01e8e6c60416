// Puts its input in place of a file of a kept work folder and bakes on, for coverage-guided fuzzing: the bake ends, or
// refuses with a message. The first byte says which file.
#include "harness.h"
#include "kept_work.h"
#include "sound_scene.h"

#include <octalux/base.h>

#include <stdlib.h>

static kept_work work;

static void remove_work(void) {
  kept_work_remove(fuzz_folder());
  kept_work_free(&work);
}

static void make_work(void) {
  sound_scene_demand(kept_work_bake(fuzz_folder()) == OLX_OK && kept_work_read(fuzz_folder(), &work) && work.count > 3,
                     "a work folder");
  atexit(remove_work);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size_bytes) {
  if (size_bytes == 0) return 0;
  if (work.count == 0) make_work();
  fuzz_begin();
  uint8_t *bytes = fuzz_copy(data + 1, size_bytes - 1);
  sound_scene_demand(kept_work_write(fuzz_folder(), &work, data[0] % work.count, bytes, size_bytes - 1), "a file");
  free(bytes);
  if (kept_work_bake(fuzz_folder()) != OLX_OK) sound_scene_demand(olx_last_error()[0], "a refusal without a message");
  fuzz_end(size_bytes, 4096);
  return 0;
}
