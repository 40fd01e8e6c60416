// Arrays whose sizes are known before they are allocated. One list describes them both for allocation and for the
// memory estimate, so that a bake takes the memory that it says it needs.
#ifndef OLX_BAKE_ARRAYS_H
#define OLX_BAKE_ARRAYS_H

#include "core/hooks.h"

#include <string.h>

typedef struct olx_array_row {
  void *at; // address of the pointer to the array, whatever its type
  uint64_t count;
  size_t element_bytes;
  bool zeroed;
} olx_array_row;

static inline uint64_t olx_arrays_bytes(const olx_array_row *rows, uint32_t count) {
  uint64_t bytes = 0;
  for (uint32_t i = 0; i < count; i++) bytes += rows[i].count * rows[i].element_bytes;
  return bytes;
}

// Allocates every array of the list; a failed allocation leaves NULL. Returns false when one failed.
static inline bool olx_arrays_allocate(const olx_array_row *rows, uint32_t count) {
  bool complete = true;
  for (uint32_t i = 0; i < count; i++) {
    void *memory = rows[i].zeroed ? olx_allocate_zero(rows[i].count, rows[i].element_bytes)
                                  : olx_allocate(rows[i].count, rows[i].element_bytes);
    memcpy(rows[i].at, &memory, sizeof memory);
    complete = complete && memory;
  }
  return complete;
}

#endif
