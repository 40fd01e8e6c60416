// Packed fields as tests spoil them: a file in memory whose checksums are made right again.
#ifndef PACKED_FIELDS_H
#define PACKED_FIELDS_H

#include "export/packed_format.h"

#include <octalux/export.h>

// A packed field in memory; `bytes` is to be given to olx_release, the others point into it.
typedef struct packed_image {
  unsigned char *bytes;
  size_t size_bytes;
  olx_file_header *header;
  olx_file_chunk *chunks; // the first holds header and chunk table of the field
  olx_file_header *field_header;
  olx_file_chunk *field_chunks;
} packed_image;

// `room_bytes` more may be written behind the file.
packed_image packed_image_load(const char *path, size_t room_bytes);
// Make every checksum of the packed file right again, and those of the field's header and table; what lies outside the
// file is left.
void packed_image_seal(const packed_image *i);
// The first of the words of a chunk's blocks, `index` as in the field: 4 bytes that need not be aligned.
unsigned char *packed_image_words(const packed_image *i, uint32_t index);

#endif
