// Scenes for tests of cooked files, and the cooked files in memory.
#ifndef OLX_TESTS_COOKED_SCENES_H
#define OLX_TESTS_COOKED_SCENES_H

#include "core/chunk_file.h"
#include "scene/cooked_format.h"
#include "scene_files.h"

#include <octalux/scene.h>

// Write a description that uses all there is (textures, an environment's image, every kind of light, cameras, all that
// can be said about probes, something to warn about) and return its path.
const char *cooked_scenes_everything(const scene_folder *folder);

// A cooked file's bytes, on a boundary of 64.
typedef struct cooked_bytes {
  uint8_t *bytes;
  size_t size_bytes;
} cooked_bytes;

cooked_bytes cooked_bytes_read(const char *path);
void cooked_bytes_free(cooked_bytes *file);

// Make every checksum right that lies inside the file.
void cooked_bytes_seal(cooked_bytes file);

// The bytes of a chunk, by its place in the file; none where the table points outside.
cooked_bytes cooked_bytes_chunk(cooked_bytes file, uint32_t index);

#endif
