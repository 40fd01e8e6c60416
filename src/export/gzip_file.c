// Writes files compressed by gzip, which browsers unpack.
#include "core/file.h"
#include "core/hooks.h"
#include "core/result.h"

#include <octalux/export.h>

#include <string.h>
#include <zlib.h>

enum { PIECE = 1 << 18, GZIP_WINDOW = 15 + 16, MEMORY_LEVEL = 9 };

// Writes the compressor's output so far to the file.
static olx_result write_pieces(z_stream *stream, int flush, olx_output_file *file, uint8_t *piece) {
  do {
    stream->next_out = piece;
    stream->avail_out = PIECE;
    deflate(stream, flush);
    OLX_TRY(olx_output_write(file, piece, PIECE - stream->avail_out));
  } while (stream->avail_out == 0);
  return OLX_OK;
}

static olx_result compress_into(const olx_mapped_file *from, z_stream *stream, olx_output_file *file, uint8_t *piece) {
  for (size_t at = 0; at < from->size_bytes; at += PIECE) {
    const size_t rest = from->size_bytes - at;
    stream->next_in = (Bytef *)(uintptr_t)((const char *)from->data + at);
    stream->avail_in = rest < PIECE ? (uInt)rest : PIECE;
    OLX_TRY(write_pieces(stream, Z_NO_FLUSH, file, piece));
  }
  return write_pieces(stream, Z_FINISH, file, piece);
}

static olx_result compress_file(const olx_mapped_file *from, olx_output_file *file, uint64_t *file_bytes) {
  z_stream stream = {0};
  uint8_t *piece = olx_allocate(PIECE, 1);
  const bool begun = piece && deflateInit2(&stream, Z_BEST_COMPRESSION, Z_DEFLATED, GZIP_WINDOW, MEMORY_LEVEL,
                                           Z_DEFAULT_STRATEGY) == Z_OK;
  olx_result result = begun ? compress_into(from, &stream, file, piece)
                            : olx_fail(OLX_ERROR_MEMORY, "%s: no memory to compress", file->path);
  if (file_bytes) *file_bytes = stream.total_out;
  if (begun) deflateEnd(&stream);
  olx_release(piece);
  return result;
}

olx_result olx_export_gzip(const char *from, const char *path, uint64_t *file_bytes) {
  olx_mapped_file input = {0};
  olx_output_file file = {0};
  OLX_TRY(olx_map_file(from, &input));
  olx_result result = olx_output_open_in_order(path, &file);
  if (result == OLX_OK) {
    result = compress_file(&input, &file, file_bytes);
    if (result == OLX_OK) result = olx_output_commit(&file);
    olx_output_discard(&file);
  }
  olx_unmap_file(&input);
  return result;
}
