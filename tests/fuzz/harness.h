// Coverage-guided fuzzing: functions that the targets in this folder share. A target is a function that takes the bytes
// of a file and calls abort() when a promise does not hold. libFuzzer calls it in builds with OLX_FUZZ; elsewhere
// replay.c calls it with files.
#pragma once

#include "scene_files.h"

#include <stddef.h>
#include <stdint.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size_bytes);

// Returns a folder under TMPDIR that exists as long as the process; the first call makes it and starts to count memory.
const scene_folder *fuzz_folder(void);

// Returns a copy of the bytes, aligned to 64 and exactly as long, so that the address sanitizer detects a read of the
// first byte beyond. Corrects the checksums that Octalux's binary files share, wherever they are checked. Free with
// free().
uint8_t *fuzz_copy(const uint8_t *data, size_t size_bytes);

// Is called before and after each input: checks that no memory is left, and that no more was requested than `factor`
// bytes for each byte of the input and 64 MiB.
void fuzz_begin(void);
void fuzz_end(size_t size_bytes, size_t factor);

// A byte of a compressed image may hold 16384 texels of 4 bytes, and reading them takes as much again.
#define FUZZ_SCENE_FACTOR ((size_t)128 << 10)

// Loads the scene, checks its contents or the message of its refusal, and frees it.
void fuzz_scene(const char *path);
