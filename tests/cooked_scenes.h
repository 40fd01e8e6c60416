// Scenes for tests of cooked files, and the cooked files in memory.
#ifndef OLX_TESTS_COOKED_SCENES_H
#define OLX_TESTS_COOKED_SCENES_H

#include "core/chunk_file.h"
#include "scene/cooked/cooked_format.h"
#include "scene_files.h"

#include <octalux/scene.h>

// Writes a description that uses every feature (textures, an environment's image, every kind of light, cameras, all
// settings of probes, something to warn about) and returns its path.
const char *cooked_scenes_everything(const scene_folder *folder);

// The bytes of a cooked file, aligned to 64.
typedef struct cooked_bytes {
  uint8_t *bytes;
  size_t size_bytes;
} cooked_bytes;

cooked_bytes cooked_bytes_read(const char *path);
void cooked_bytes_free(cooked_bytes *file);

// Correct every checksum whose chunk is inside the file.
void cooked_bytes_seal(cooked_bytes file);

// Returns the bytes of the chunk at `index` of the table, or none where the table points outside the file.
cooked_bytes cooked_bytes_chunk(cooked_bytes file, uint32_t index);

#endif
