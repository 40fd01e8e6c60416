// Loads its input as a file of probes, saves them, and loads them again, for coverage-guided fuzzing; the number of
// probes stays.
#include "harness.h"
#include "sound_scene.h"

#include <octalux/place.h>

#include <stdio.h>

static void save_and_load(const olx_probe_set *set) {
  olx_probe_set again;
  char path[400];
  snprintf(path, sizeof path, "%s/again.json", fuzz_folder()->path);
  sound_scene_demand(olx_probe_set_save(set, path) == OLX_OK, "probes that cannot be saved");
  sound_scene_demand(olx_probe_set_load(path, set->origin, &again) == OLX_OK && again.count == set->count,
                     "saved probes that do not load");
  olx_probe_set_free(&again);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size_bytes) {
  static const double origin[3] = {1.0, -2.0, 1e6};
  olx_probe_set set;
  fuzz_begin();
  if (olx_probe_set_load(scene_folder_write(fuzz_folder(), "input.json", data, size_bytes), origin, &set) == OLX_OK) {
    save_and_load(&set);
    olx_probe_set_free(&set);
  } else {
    sound_scene_demand(olx_last_error()[0], "a refusal without a message");
  }
  fuzz_end(size_bytes, 4096);
  return 0;
}
