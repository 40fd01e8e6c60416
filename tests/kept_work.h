// A tiny bake whose work folder is kept, for fuzzers of what such a folder holds.
#ifndef OLX_TESTS_KEPT_WORK_H
#define OLX_TESTS_KEPT_WORK_H

#include "scene_files.h"

#include <octalux/base.h>

enum { KEPT_WORK_FILES = 64 }; // at most

typedef struct kept_work_file {
  char name[64];
  uint8_t *bytes;
  size_t size_bytes;
} kept_work_file;

// The files of a work folder, by name.
typedef struct kept_work {
  kept_work_file files[KEPT_WORK_FILES];
  uint32_t count;
} kept_work;

// Bakes the scene of `folder`, which it writes there, with the work folder "work" beside it, which stays.
olx_result kept_work_bake(const scene_folder *folder);
// Reads all files of the work folder; false where that fails. Free them with kept_work_free.
bool kept_work_read(const scene_folder *folder, kept_work *work);
void kept_work_free(kept_work *work);
// Makes the work folder anew with these files, but with `bytes` in file `changed`.
bool kept_work_write(const scene_folder *folder, const kept_work *work, uint32_t changed, const uint8_t *bytes,
                     size_t size_bytes);
// Removes the work folder with all files in it.
void kept_work_remove(const scene_folder *folder);

#endif
