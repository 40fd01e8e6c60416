// Packed fields for tests that damage them: a file in memory whose checksums can be made right again.
#ifndef PACKED_FIELDS_H
#define PACKED_FIELDS_H

#include "export/packed_format.h"

#include <octalux/export.h>

// A packed field in memory; `bytes` is to be given to olx_release, the others point into it.
typedef struct packed_image {
  unsigned char *bytes;
  size_t size_bytes;
  olx_file_header *header;
  olx_file_chunk *chunks; // the first chunk holds the field's header and chunk table
  olx_file_header *field_header;
  olx_file_chunk *field_chunks;
} packed_image;

// Loads a packed field, with room for `room_bytes` more behind the file.
packed_image packed_image_load(const char *path, size_t room_bytes);
// Makes every checksum of the packed file right again, and those of the field's header and table; entries that point
// outside the file are not changed.
void packed_image_seal(const packed_image *i);
// Returns the first word of the blocks of chunk `index` of the field: 4 bytes that need not be aligned.
unsigned char *packed_image_words(const packed_image *i, uint32_t index);

#endif
