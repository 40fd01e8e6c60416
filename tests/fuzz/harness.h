// Coverage-guided fuzzing: what the targets in this folder share. A target is a function that takes bytes, as a file
// would hold them, and ends in abort() when a promise does not hold. libFuzzer calls it in builds with OLX_FUZZ;
// elsewhere replay.c calls it with files.
#pragma once

#include "scene_files.h"

#include <stddef.h>
#include <stdint.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size_bytes);

// A folder under TMPDIR that lives as long as the process, made by the first call; memory is counted from then on.
const scene_folder *fuzz_folder(void);

// A copy of the bytes, aligned to 64 and exactly as long, so that the address sanitizer sees the first byte beyond.
// Checksums of the frame that Octalux's binary files share are made right where they are checked. For free().
uint8_t *fuzz_copy(const uint8_t *data, size_t size_bytes);

// Before and after each input: no memory is left, and what was asked for is in proportion to the input, `factor` bytes
// a byte and 64 MiB.
void fuzz_begin(void);
void fuzz_end(size_t size_bytes, size_t factor);

// Texels of 4 bytes, 16384 of them a byte of a compressed image, and as much again to read them.
#define FUZZ_SCENE_FACTOR ((size_t)128 << 10)

// Load the scene, check what it holds or what the refusal says, and free it.
void fuzz_scene(const char *path);
