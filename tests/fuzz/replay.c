// Runs a target of coverage-guided fuzzing on files, in builds without libFuzzer: replay_TARGET FILE...
#include "harness.h"

#include <stdio.h>
#include <stdlib.h>

static void replay(const char *path) {
  FILE *file = fopen(path, "rb");
  if (!file || fseek(file, 0, SEEK_END) != 0) {
    perror(path);
    exit(1);
  }
  const size_t size_bytes = (size_t)ftell(file);
  uint8_t *bytes = malloc(size_bytes ? size_bytes : 1);
  rewind(file);
  if (!bytes || fread(bytes, 1, size_bytes, file) != size_bytes) exit(1);
  fclose(file);
  fprintf(stderr, "%s: %zu bytes\n", path, size_bytes); // names the file in the last line before a crash
  (void)LLVMFuzzerTestOneInput(bytes, size_bytes);
  free(bytes);
}

int main(int argc, char **argv) {
  for (int i = 1; i < argc; i++) replay(argv[i]);
  printf("%d files, 0 failures\n", argc - 1);
  return argc > 1 ? 0 : 1;
}
