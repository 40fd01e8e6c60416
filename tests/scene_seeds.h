// The files that fuzzers of scenes begin from: small, valid, and together with every feature that the importers read.
#pragma once

#include <stddef.h>
#include <stdint.h>

typedef struct seed_file {
  const char *name, *opened; // the file that is mutated, and the file that is loaded
  uint8_t *bytes;
  size_t size_bytes;
} seed_file;

enum { SEED_COUNT = 13 };

void scene_seeds_make(seed_file seeds[SEED_COUNT]);
void scene_seeds_free(seed_file seeds[SEED_COUNT]);
