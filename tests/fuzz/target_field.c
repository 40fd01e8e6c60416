// Opens its input as a field in memory, verifies, samples and relights it, for coverage-guided fuzzing.
#include "harness.h"
#include "hostile_field.h"

#include "core/chunk_file.h"

#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size_bytes) {
  fuzz_begin();
  uint8_t *bytes = fuzz_copy(data, size_bytes);
  dice d = {.seed = (uint32_t)olx_content_hash(data, size_bytes)};
  field_counts counts = {0};
  hostile_field_use(&d, bytes, size_bytes, &counts);
  free(bytes);
  fuzz_end(size_bytes, 4096); // a large factor, for relighting and lists of boxes
  return 0;
}
