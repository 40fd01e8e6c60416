// Collects results that are written to a file in a growing buffer, and checks the bounds of results read from one.
#include "work/byte_stream.h"

#include "core/hooks.h"
#include "core/result.h"

#include <string.h>

static size_t aligned(size_t size_bytes) {
  return (size_bytes + OLX_BYTES_ALIGNMENT - 1) / OLX_BYTES_ALIGNMENT * OLX_BYTES_ALIGNMENT;
}

static bool grow(olx_byte_writer *to, size_t more) {
  enum { LEAST = 4096 };
  if (to->capacity - to->size_bytes >= more) return true;
  size_t capacity = to->capacity ? 2 * to->capacity : LEAST;
  while (capacity - to->size_bytes < more) capacity *= 2;
  char *larger = olx_allocate(capacity, 1);
  if (!larger) return false;
  if (to->size_bytes > 0) memcpy(larger, to->data, to->size_bytes);
  olx_release(to->data);
  to->data = larger;
  to->capacity = capacity;
  return true;
}

void olx_bytes_put(olx_byte_writer *to, const void *elements, size_t count, size_t element_bytes) {
  const size_t size_bytes = count * element_bytes, padded = aligned(size_bytes);
  to->failed = to->failed || !grow(to, padded);
  if (to->failed || size_bytes == 0) return;
  memcpy(to->data + to->size_bytes, elements, size_bytes);
  memset(to->data + to->size_bytes + size_bytes, 0, padded - size_bytes);
  to->size_bytes += padded;
}

void olx_bytes_reserve(olx_byte_writer *to, size_t more_bytes) { to->failed = to->failed || !grow(to, more_bytes); }

void olx_byte_writer_free(olx_byte_writer *to) {
  olx_release(to->data);
  *to = (olx_byte_writer){0};
}

const void *olx_bytes_get(olx_byte_reader *from, size_t count, size_t element_bytes) {
  const size_t left = from->size_bytes - from->next;
  if (from->failed || count > left / element_bytes || aligned(count * element_bytes) > left) {
    from->failed = true;
    return NULL;
  }
  const void *found = from->data + from->next;
  from->next += aligned(count * element_bytes);
  return found;
}

void olx_bytes_copy(olx_byte_reader *from, void *elements, size_t count, size_t element_bytes) {
  const void *found = olx_bytes_get(from, count, element_bytes);
  if (found && count > 0) memcpy(elements, found, count * element_bytes);
}

void *olx_bytes_take(olx_byte_reader *from, size_t count, size_t element_bytes) {
  const void *found = olx_bytes_get(from, count, element_bytes);
  void *array = found ? olx_allocate(count, element_bytes) : NULL;
  from->failed |= !array;
  if (array && count > 0) memcpy(array, found, count * element_bytes);
  return array;
}

olx_result olx_bytes_end(const olx_byte_reader *from, const char *name) {
  if (!from->failed && from->next == from->size_bytes) return OLX_OK;
  return olx_fail(OLX_ERROR_FORMAT, "%s: does not hold what it should", name);
}
