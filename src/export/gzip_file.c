// Writes files compressed by gzip, which browsers unpack.
#include "export/gzip_file.h"

#include "core/hooks.h"
#include "core/result.h"

#include <octalux/export.h>

enum { PIECE = 1 << 18, GZIP_WINDOW = 15 + 16, MEMORY_LEVEL = 9 };

olx_result olx_gzip_create(const char *path, olx_gzip_file *file) {
  *file = (olx_gzip_file){.piece = olx_allocate(PIECE, 1)};
  const bool begun = file->piece && deflateInit2(&file->stream, Z_BEST_COMPRESSION, Z_DEFLATED, GZIP_WINDOW,
                                                 MEMORY_LEVEL, Z_DEFAULT_STRATEGY) == Z_OK;
  const olx_result result = begun ? olx_output_open_in_order(path, &file->output)
                                  : olx_fail(OLX_ERROR_MEMORY, "%s: no memory to compress", path);
  if (result == OLX_OK) return OLX_OK;
  if (begun) deflateEnd(&file->stream);
  olx_release(file->piece);
  return result;
}

// Writes the compressor's output so far to the file.
static olx_result write_pieces(olx_gzip_file *file, int flush) {
  do {
    file->stream.next_out = file->piece;
    file->stream.avail_out = PIECE;
    deflate(&file->stream, flush);
    OLX_TRY(olx_output_write(&file->output, file->piece, PIECE - file->stream.avail_out));
  } while (file->stream.avail_out == 0);
  return OLX_OK;
}

olx_result olx_gzip_write(olx_gzip_file *file, const void *data, size_t size_bytes) {
  for (size_t at = 0; at < size_bytes; at += PIECE) {
    const size_t rest = size_bytes - at;
    file->stream.next_in = (Bytef *)(uintptr_t)((const char *)data + at);
    file->stream.avail_in = rest < PIECE ? (uInt)rest : PIECE;
    OLX_TRY(write_pieces(file, Z_NO_FLUSH));
  }
  return OLX_OK;
}

olx_result olx_gzip_commit(olx_gzip_file *file, uint64_t *file_bytes) {
  OLX_TRY(write_pieces(file, Z_FINISH));
  if (file_bytes) *file_bytes = file->stream.total_out;
  return olx_output_commit(&file->output);
}

void olx_gzip_discard(olx_gzip_file *file) {
  olx_output_discard(&file->output);
  deflateEnd(&file->stream);
  olx_release(file->piece);
}

olx_result olx_export_gzip(const char *from, const char *path, uint64_t *file_bytes) {
  olx_mapped_file input = {0};
  olx_gzip_file file;
  OLX_TRY(olx_map_file(from, &input));
  olx_result result = olx_gzip_create(path, &file);
  if (result == OLX_OK) {
    result = olx_gzip_write(&file, input.data, input.size_bytes);
    if (result == OLX_OK) result = olx_gzip_commit(&file, file_bytes);
    olx_gzip_discard(&file);
  }
  olx_unmap_file(&input);
  return result;
}
