// Writes a file compressed by gzip piece by piece, through a temporary file that is synced and renamed.
#ifndef OLX_EXPORT_GZIP_FILE_H
#define OLX_EXPORT_GZIP_FILE_H

#include "core/file.h"

#include <zlib.h>

typedef struct olx_gzip_file {
  olx_output_file output;
  z_stream stream;
  uint8_t *piece; // compressed bytes on their way to the file
} olx_gzip_file;

// Begins a file. After a failure there is nothing to discard.
olx_result olx_gzip_create(const char *path, olx_gzip_file *file);
olx_result olx_gzip_write(olx_gzip_file *file, const void *data, size_t size_bytes);
// Completes the file and gives it its name; file_bytes, which may be NULL, receives its size. olx_gzip_discard must
// follow in any case.
olx_result olx_gzip_commit(olx_gzip_file *file, uint64_t *file_bytes);
// Frees what the file holds, and removes it unless it was committed.
void olx_gzip_discard(olx_gzip_file *file);

#endif
