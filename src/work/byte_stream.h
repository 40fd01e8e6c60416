// Serialization: bytes appended to a growing buffer, and read again in the same order.
#ifndef OLX_WORK_BYTE_STREAM_H
#define OLX_WORK_BYTE_STREAM_H

#include <octalux/base.h>

enum { OLX_BYTES_ALIGNMENT = 16 }; // alignment of every put, relative to the first byte

// A growing buffer. Zero-initialize. Failures are sticky, so that it suffices to check once at the end.
typedef struct olx_byte_writer {
  char *data;
  size_t size_bytes, capacity;
  bool failed; // out of memory
} olx_byte_writer;

// Appends `count` elements; `elements` may be NULL when that is 0.
void olx_bytes_put(olx_byte_writer *to, const void *elements, size_t count, size_t element_bytes);
// Makes room for that many more bytes at once.
void olx_bytes_reserve(olx_byte_writer *to, size_t more_bytes);
void olx_byte_writer_free(olx_byte_writer *to);

typedef struct olx_byte_reader {
  const char *data; // 64-byte aligned
  size_t size_bytes, next;
  bool failed; // more was read than there is
} olx_byte_reader;

// Returns the next elements, owned by the reader's owner; NULL where the bytes end before.
const void *olx_bytes_get(olx_byte_reader *from, size_t count, size_t element_bytes);
// Copies the next elements to `elements`, which is unchanged where the bytes end before.
void olx_bytes_copy(olx_byte_reader *from, void *elements, size_t count, size_t element_bytes);
// Copies the next elements to a new array, which the caller releases with olx_release; NULL, with `failed` set, where
// the bytes or memory run out.
void *olx_bytes_take(olx_byte_reader *from, size_t count, size_t element_bytes);
// Returns OLX_ERROR_FORMAT unless all bytes were read and none was missing.
olx_result olx_bytes_end(const olx_byte_reader *from, const char *name);

#endif
