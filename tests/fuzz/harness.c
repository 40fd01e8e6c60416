// Gives the targets of coverage-guided fuzzing their shared means: a folder, copies of inputs, counted memory and
// checks of scenes.
#include "harness.h"

#include "cooked_scenes.h"
#include "counted_memory.h"
#include "sound_scene.h"

#include <stdlib.h>
#include <string.h>

static scene_folder folder;

static void remove_folder(void) { scene_folder_remove(&folder); }

const scene_folder *fuzz_folder(void) {
  if (folder.path[0]) return &folder;
  counted_memory_begin();
  if (!scene_folder_create(&folder)) abort();
  atexit(remove_folder);
  return &folder;
}

uint8_t *fuzz_copy(const uint8_t *data, size_t size_bytes) {
  void *copy = NULL;
  if (posix_memalign(&copy, 64, size_bytes ? size_bytes : 1) != 0) abort();
  if (size_bytes) memcpy(copy, data, size_bytes);
#ifndef OLX_ANY_CHECKSUM
  cooked_bytes_seal((cooked_bytes){.bytes = copy, .size_bytes = size_bytes});
#endif
  return copy;
}

void fuzz_begin(void) {
  (void)fuzz_folder();
  counted_memory_asked();
}

void fuzz_end(size_t size_bytes, size_t factor) {
  sound_scene_demand(counted_memory_held() == 0, "memory that was not released");
  sound_scene_demand(counted_memory_asked() <= ((size_t)64 << 20) + size_bytes * factor, "memory out of proportion");
}

void fuzz_scene(const char *path) {
  olx_scene *scene;
  if (olx_scene_load(path, &scene) == OLX_OK) sound_scene_check(scene);
  else sound_scene_demand(scene == NULL && olx_last_error()[0], "a refusal without a message");
  olx_scene_free(scene);
}
