// Bytes written one after the other into memory that grows, and read again in the same order.
#ifndef OLX_WORK_BYTE_STREAM_H
#define OLX_WORK_BYTE_STREAM_H

#include <octalux/base.h>

enum { OLX_BYTES_ALIGNMENT = 16 }; // of everything that is put, from the first byte on

// Zero-initialise. A failure is kept: whoever is done looks once.
typedef struct olx_byte_writer {
  char *data;
  size_t size_bytes, capacity;
  bool failed; // memory is out
} olx_byte_writer;

// Appends `count` elements; none may be NULL.
void olx_bytes_put(olx_byte_writer *to, const void *elements, size_t count, size_t element_bytes);
void olx_byte_writer_free(olx_byte_writer *to);

typedef struct olx_byte_reader {
  const char *data; // 64-byte aligned
  size_t size_bytes, next;
  bool failed; // something was sought that is not there
} olx_byte_reader;

// The next elements, which belong to whom the reader belongs to; NULL where the bytes end before.
const void *olx_bytes_get(olx_byte_reader *from, size_t count, size_t element_bytes);
// Copies the next elements to `elements`, which is left alone where the bytes end before.
void olx_bytes_copy(olx_byte_reader *from, void *elements, size_t count, size_t element_bytes);
// The next elements as an array that is the caller's, to be given to olx_release; NULL, and `failed`, where bytes or
// memory end.
void *olx_bytes_take(olx_byte_reader *from, size_t count, size_t element_bytes);
// OLX_ERROR_FORMAT unless all bytes were read and none was missing.
olx_result olx_bytes_end(const olx_byte_reader *from, const char *name);

#endif
