// Packs fields in memory, for tests that spoil them.
#include "packed_fields.h"

#include "core/hooks.h"
#include "synthetic_field.h"

#include <string.h>

packed_image packed_image_load(const char *path, size_t room_bytes) {
  packed_image i = {0};
  unsigned char *file = synthetic_read_file(path, &i.size_bytes);
  i.bytes = olx_allocate(i.size_bytes + room_bytes, 1);
  memcpy(i.bytes, file, i.size_bytes);
  olx_release(file);
  i.header = (olx_file_header *)i.bytes;
  i.chunks = (olx_file_chunk *)(i.header + 1);
  i.field_header = (olx_file_header *)(i.bytes + i.chunks[0].offset);
  i.field_chunks = (olx_file_chunk *)(i.field_header + 1);
  return i;
}

static bool holds(const packed_image *i, const void *at, uint64_t size_bytes) {
  const uint64_t offset = (uint64_t)((const unsigned char *)at - i->bytes);
  return offset <= i->size_bytes && size_bytes <= i->size_bytes - offset;
}

static void seal_header(const packed_image *i, olx_file_header *header) {
  if (!holds(i, header, sizeof *header)) return;
  const uint64_t table_bytes = header->chunk_count * (uint64_t)sizeof(olx_file_chunk);
  if (holds(i, header + 1, table_bytes)) header->table_hash = olx_content_hash(header + 1, (size_t)table_bytes);
  header->header_hash = olx_content_hash(header, offsetof(olx_file_header, header_hash));
}

void packed_image_seal(const packed_image *i) {
  if (!holds(i, i->header, sizeof *i->header)) return;
  seal_header(i, i->field_header);
  for (uint32_t k = 0; k < i->header->chunk_count && holds(i, &i->chunks[k], sizeof *i->chunks); k++) {
    olx_file_chunk *chunk = &i->chunks[k];
    if (chunk->offset > i->size_bytes || chunk->size_bytes > i->size_bytes - chunk->offset) continue;
    chunk->hash = olx_content_hash(i->bytes + chunk->offset, chunk->size_bytes);
  }
  seal_header(i, i->header);
}

unsigned char *packed_image_words(const packed_image *i, uint32_t index) {
  const olx_file_chunk *chunk = &i->chunks[index + 1];
  const uint64_t blocks = olx_packed_blocks(i->field_chunks[index].size_bytes);
  return i->bytes + chunk->offset + chunk->size_bytes - blocks * sizeof(uint32_t);
}
