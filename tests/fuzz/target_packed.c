// Describes and unpacks its input as a packed field, for coverage-guided fuzzing; the unpacked field has the declared
// size.
#include "harness.h"
#include "sound_scene.h"

#include <octalux/export.h>

#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

static void unpack(const char *path, size_t size_bytes) {
  const olx_unpack_settings settings = {.most_bytes = 1 << 24, .threads = 1};
  olx_packed_info info;
  char back[400];
  struct stat status;
  snprintf(back, sizeof back, "%s/back.olx", fuzz_folder()->path);
  unlink(back);
  (void)olx_packed_describe(path, &info);
  if (olx_field_unpack(path, &settings, back, NULL, &info) == OLX_OK) {
    const bool whole = stat(back, &status) == 0 && (uint64_t)status.st_size == info.field_bytes;
    sound_scene_demand(whole && info.packed_bytes == size_bytes, "sizes of an unpacked field");
  } else {
    sound_scene_demand(olx_last_error()[0] && access(back, F_OK) != 0, "a refused file left an output");
  }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size_bytes) {
  fuzz_begin();
  uint8_t *bytes = fuzz_copy(data, size_bytes);
  unpack(scene_folder_write(fuzz_folder(), "input.olxz", bytes, size_bytes), size_bytes);
  free(bytes);
  fuzz_end(size_bytes, 4096);
  return 0;
}
