// The bytes of a packed field, shared by what packs and what unpacks. docs/format.md, "Packed fields", is the
// specification.
#ifndef OLX_EXPORT_PACKED_FORMAT_H
#define OLX_EXPORT_PACKED_FORMAT_H

#include "core/chunk_file.h"
#include "core/file.h"
#include "field/field_file.h"

#include <octalux/export.h>

#define OLX_PACKED_KIND                                                                                                \
  ((olx_file_kind){.magic = OLX_PACKED_MAGIC, .version = 1, .noun = "packed field", .remedy = "; pack the field again"})

// The chunk that holds the header and the chunk table of the field; it comes first.
#define OLX_PACKED_TABLE OLX_FOUR_CC('T', 'A', 'B', 'L')

enum {
  OLX_PACKED_BLOCK_BYTES = 1 << 20, // of a field's chunk, packed together
  OLX_PACKED_MOST_BLOCK_BYTES = OLX_PACKED_BLOCK_BYTES + (1 << 13),
  // A block's word: its packed bytes in the low 24 bits, the filter that it went through in the high 8.
  OLX_PACKED_FILTER_SHIFT = 24,
  OLX_PACKED_SIZE_MASK = (1 << OLX_PACKED_FILTER_SHIFT) - 1,
  OLX_PACKED_MOST_THREADS = 64 // each of which has room for a block
};

static inline uint64_t olx_packed_blocks(uint64_t chunk_bytes) {
  return (chunk_bytes + OLX_PACKED_BLOCK_BYTES - 1) / OLX_PACKED_BLOCK_BYTES;
}

// Bytes of block `index` of a chunk before packing.
static inline size_t olx_packed_block_bytes(uint64_t chunk_bytes, uint64_t index) {
  const uint64_t left = chunk_bytes - index * OLX_PACKED_BLOCK_BYTES;
  return left < OLX_PACKED_BLOCK_BYTES ? (size_t)left : OLX_PACKED_BLOCK_BYTES;
}

// A packed file in memory whose header and tables are sound, and which agree with each other.
typedef struct olx_packed_file {
  olx_mapped_file mapped;
  olx_chunk_file file;
  olx_chunk_file field; // header and chunk table alone, of the field's size
  uint32_t chunk_count; // of the field
} olx_packed_file;

// Chunk `index` of the field, and what it was packed into.
static inline const olx_file_chunk *olx_packed_field_chunk(const olx_packed_file *packed, uint32_t index) {
  return &olx_chunk_table(&packed->field)[index];
}
static inline const olx_file_chunk *olx_packed_chunk_of(const olx_packed_file *packed, uint32_t index) {
  return &olx_chunk_table(&packed->file)[index + 1];
}

// Close with olx_packed_close, whatever comes back.
olx_result olx_packed_open(const char *path, olx_packed_file *packed);
void olx_packed_close(olx_packed_file *packed);
olx_packed_info olx_packed_info_of(const olx_packed_file *packed);

// Blocks of all chunks of a field, whose header and table alone are read.
uint64_t olx_packed_count_blocks(const olx_chunk_file *field);
// How many blocks are worked on at once; `threads` as settings have it.
uint32_t olx_packed_threads(uint32_t threads);

#endif
