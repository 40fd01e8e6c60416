// The layout of a packed field, shared by packing and unpacking. docs/format.md, "Packed fields", is the specification.
#ifndef OLX_EXPORT_PACKED_FORMAT_H
#define OLX_EXPORT_PACKED_FORMAT_H

#include "core/chunk_file.h"
#include "core/file.h"
#include "field/field_file.h"

#include <octalux/export.h>

#define OLX_PACKED_KIND                                                                                                \
  ((olx_file_kind){.magic = OLX_PACKED_MAGIC, .version = 1, .noun = "packed field", .remedy = "; pack the field again"})

// The chunk that holds the header and the chunk table of the field; always the first.
#define OLX_PACKED_TABLE OLX_FOUR_CC('T', 'A', 'B', 'L')

enum {
  OLX_PACKED_BLOCK_BYTES = 1 << 20, // bytes of a field's chunk that are packed together
  OLX_PACKED_MOST_BLOCK_BYTES = OLX_PACKED_BLOCK_BYTES + (1 << 13),
  // A block's word: its packed size in the low 24 bits, its filter in the high 8.
  OLX_PACKED_FILTER_SHIFT = 24,
  OLX_PACKED_SIZE_MASK = (1 << OLX_PACKED_FILTER_SHIFT) - 1,
  OLX_PACKED_MOST_THREADS = 64 // bounds the memory for blocks
};

static inline uint64_t olx_packed_blocks(uint64_t chunk_bytes) {
  return (chunk_bytes + OLX_PACKED_BLOCK_BYTES - 1) / OLX_PACKED_BLOCK_BYTES;
}

// Returns the size of block `index` of a chunk before packing, in bytes.
static inline size_t olx_packed_block_bytes(uint64_t chunk_bytes, uint64_t index) {
  const uint64_t left = chunk_bytes - index * OLX_PACKED_BLOCK_BYTES;
  return left < OLX_PACKED_BLOCK_BYTES ? (size_t)left : OLX_PACKED_BLOCK_BYTES;
}

// A packed file in memory whose header and tables are valid and consistent.
typedef struct olx_packed_file {
  olx_mapped_file mapped;
  olx_chunk_file file;
  olx_chunk_file field; // header and chunk table alone, with the field's size
  uint32_t chunk_count; // number of the field's chunks
} olx_packed_file;

// Returns chunk `index` of the field, before packing, and the packed chunk.
static inline const olx_file_chunk *olx_packed_field_chunk(const olx_packed_file *packed, uint32_t index) {
  return &olx_chunk_table(&packed->field)[index];
}
static inline const olx_file_chunk *olx_packed_chunk_of(const olx_packed_file *packed, uint32_t index) {
  return &olx_chunk_table(&packed->file)[index + 1];
}

// Opens a packed file. The caller closes it with olx_packed_close, also after a failure.
olx_result olx_packed_open(const char *path, olx_packed_file *packed);
void olx_packed_close(olx_packed_file *packed);
olx_packed_info olx_packed_info_of(const olx_packed_file *packed);

// Returns the number of blocks of all chunks of a field, of which only the header and the table are read.
uint64_t olx_packed_count_blocks(const olx_chunk_file *field);
// Returns the number of blocks that are processed at once; `threads` as in the settings.
uint32_t olx_packed_threads(uint32_t threads);

#endif
