// Unpacks a field: each block into a buffer of a block's size, whatever the file claims, and verifies each chunk
// against the field's checksum.
#include "core/hooks.h"
#include "core/parallel.h"
#include "core/result.h"
#include "export/block_filter.h"
#include "export/packed_format.h"
#include "export/running_hash.h"

#include <zstd.h>

// The working state of one thread that unpacks blocks.
typedef struct block_unpacker {
  ZSTD_DCtx *context;
  uint8_t *data, *room;
  const uint8_t *packed;
  uint32_t word;     // its size and filter
  size_t size_bytes; // size after unpacking
  uint8_t *result;   // either of `data` and `room`; NULL: the block is malformed
} block_unpacker;

typedef struct field_unpacker {
  olx_packed_file packed;
  uint32_t unpacker_count;
  block_unpacker *unpackers;
  olx_output_file output;
  bool writes;
  olx_task task;

  // The chunk being unpacked.
  const olx_file_chunk *field, *chunk;
  const uint8_t *words; // one u32 per block of the chunk
  olx_running_hash hash;
} field_unpacker;

olx_unpack_settings olx_unpack_settings_default(void) { return (olx_unpack_settings){.most_bytes = UINT64_C(1) << 35}; }

static olx_result write_at(field_unpacker *u, uint64_t offset, const void *data, size_t size_bytes) {
  return u->writes ? olx_output_write_at(&u->output, offset, data, size_bytes) : OLX_OK;
}

// ---- A chunk

static uint32_t read_word(const field_unpacker *u, uint64_t block) {
  uint32_t word;
  memcpy(&word, u->words + block * sizeof word, sizeof word);
  return word;
}

// Locates the blocks. Their words follow them, and all blocks together fill the space before the words.
static olx_result find_blocks(field_unpacker *u) {
  const uint64_t blocks = olx_packed_blocks(u->field->size_bytes), word_bytes = blocks * sizeof(uint32_t);
  const uint64_t packed_bytes = u->chunk->size_bytes - word_bytes; // olx_packed_open has checked that the chunk is
                                                                   // large enough
  const uint8_t *data = (const uint8_t *)u->packed.file.data + u->chunk->offset;
  uint64_t total = 0;
  u->words = data + packed_bytes;
  for (uint64_t i = 0; i < blocks; i++) {
    const uint32_t word = read_word(u, i), size_bytes = word & OLX_PACKED_SIZE_MASK;
    if (size_bytes < 1 || size_bytes > OLX_PACKED_MOST_BLOCK_BYTES ||
        !olx_filter_exists(word >> OLX_PACKED_FILTER_SHIFT, u->chunk->element_bytes)) {
      return olx_fail(OLX_ERROR_FORMAT, "%s: chunk %s: block %llu has an impossible size or filter",
                      u->packed.file.name, olx_chunk_type_name(u->field->type).text, (unsigned long long)i);
    }
    total += size_bytes;
  }
  if (total == packed_bytes) return OLX_OK;
  return olx_fail(OLX_ERROR_FORMAT, "%s: chunk %s: blocks of %llu bytes in %llu", u->packed.file.name,
                  olx_chunk_type_name(u->field->type).text, (unsigned long long)total,
                  (unsigned long long)packed_bytes);
}

static void unpack_block(void *user, uint32_t index) {
  const field_unpacker *u = user;
  block_unpacker *b = &u->unpackers[index];
  const size_t found =
      ZSTD_decompressDCtx(b->context, b->data, b->size_bytes, b->packed, b->word & OLX_PACKED_SIZE_MASK);
  b->result = found == b->size_bytes ? olx_filter_undo(b->word >> OLX_PACKED_FILTER_SHIFT, u->chunk->element_bytes,
                                                       b->data, b->room, b->size_bytes)
                                     : NULL;
}

static olx_result take_blocks(field_unpacker *u, uint64_t first, uint32_t count) {
  for (uint32_t i = 0; i < count; i++) {
    const block_unpacker *b = &u->unpackers[i];
    if (!b->result) {
      return olx_fail(OLX_ERROR_FORMAT, "%s: chunk %s: block %llu does not unpack to %zu bytes", u->packed.file.name,
                      olx_chunk_type_name(u->field->type).text, (unsigned long long)(first + i), b->size_bytes);
    }
    olx_hash_add(&u->hash, b->result, b->size_bytes);
    OLX_TRY(write_at(u, u->field->offset + (first + i) * OLX_PACKED_BLOCK_BYTES, b->result, b->size_bytes));
  }
  return OLX_OK;
}

static olx_result unpack_blocks(field_unpacker *u) {
  const uint64_t blocks = olx_packed_blocks(u->field->size_bytes);
  const uint8_t *packed = (const uint8_t *)u->packed.file.data + u->chunk->offset;
  for (uint64_t first = 0; first < blocks; first += u->unpacker_count) {
    const uint64_t left = blocks - first;
    const uint32_t count = left < u->unpacker_count ? (uint32_t)left : u->unpacker_count;
    for (uint32_t i = 0; i < count; i++) {
      block_unpacker *b = &u->unpackers[i];
      b->packed = packed;
      b->word = read_word(u, first + i);
      b->size_bytes = olx_packed_block_bytes(u->field->size_bytes, first + i);
      packed += b->word & OLX_PACKED_SIZE_MASK;
    }
    OLX_TRY(olx_parallel_for(count, u->unpacker_count, unpack_block, u, &u->task, 1));
    OLX_TRY(take_blocks(u, first, count));
  }
  return OLX_OK;
}

static olx_result unpack_chunk(field_unpacker *u, uint32_t index) {
  static const char padding[OLX_CHUNK_ALIGNMENT];
  u->field = olx_packed_field_chunk(&u->packed, index);
  u->chunk = olx_packed_chunk_of(&u->packed, index);
  OLX_TRY(olx_chunk_check_content(&u->packed.file, index + 1));
  OLX_TRY(find_blocks(u));
  olx_hash_begin(&u->hash);
  OLX_TRY(unpack_blocks(u));
  const uint64_t end = u->field->offset + u->field->size_bytes;
  OLX_TRY(write_at(u, end, padding, olx_align_chunk(end) - end));
  if (olx_checksum_holds(olx_hash_end(&u->hash), u->field->hash)) return OLX_OK;
  return olx_fail(OLX_ERROR_CHECKSUM, "%s: chunk %s: wrong checksum once it is unpacked", u->packed.file.name,
                  olx_chunk_type_name(u->field->type).text);
}

// ---- The file

static olx_result unpack_chunks(field_unpacker *u) {
  OLX_TRY(write_at(u, 0, u->packed.field.data, olx_chunk_table(&u->packed.file)->size_bytes));
  for (uint32_t i = 0; i < u->packed.chunk_count; i++) OLX_TRY(unpack_chunk(u, i));
  return OLX_OK;
}

static olx_result write_output(field_unpacker *u, const char *path) {
  u->writes = path != NULL;
  if (!u->writes) return unpack_chunks(u);
  OLX_TRY(olx_output_open(path, &u->output));
  olx_result result = olx_output_reserve(&u->output, u->packed.field.size_bytes);
  if (result == OLX_OK) result = unpack_chunks(u);
  if (result == OLX_OK) return olx_output_commit(&u->output);
  olx_output_discard(&u->output);
  return result;
}

static bool allocate_unpackers(field_unpacker *u) {
  u->unpackers = olx_allocate_zero(u->unpacker_count, sizeof *u->unpackers);
  bool all = u->unpackers != NULL;
  for (uint32_t i = 0; all && i < u->unpacker_count; i++) {
    block_unpacker *b = &u->unpackers[i];
    b->context = ZSTD_createDCtx();
    b->data = olx_allocate(OLX_PACKED_BLOCK_BYTES, 1);
    b->room = olx_allocate(OLX_PACKED_BLOCK_BYTES, 1);
    all = b->context && b->data && b->room;
  }
  return all;
}

static void release_unpackers(field_unpacker *u) {
  for (uint32_t i = 0; u->unpackers && i < u->unpacker_count; i++) {
    ZSTD_freeDCtx(u->unpackers[i].context);
    olx_release(u->unpackers[i].data);
    olx_release(u->unpackers[i].room);
  }
  olx_release(u->unpackers);
}

static olx_result unpack_field(field_unpacker *u, const char *path, const olx_progress *progress) {
  olx_result result;
  if (!allocate_unpackers(u)) {
    result = olx_fail(OLX_ERROR_MEMORY, "%s: out of memory", u->packed.file.name);
  } else {
    olx_task_begin(&u->task, progress, "unpacking", olx_packed_count_blocks(&u->packed.field));
    result = write_output(u, path);
    olx_task_end(&u->task);
  }
  release_unpackers(u);
  return result;
}

static olx_result check_size(const olx_packed_file *packed, uint64_t most_bytes) {
  const uint64_t size_bytes = packed->field.size_bytes;
  if (size_bytes <= most_bytes) return OLX_OK;
  return olx_fail(OLX_ERROR_UNSUPPORTED, "%s: unpacks to %llu bytes, more than the limit of %llu", packed->file.name,
                  (unsigned long long)size_bytes, (unsigned long long)most_bytes);
}

olx_result olx_field_unpack(const char *packed_path, const olx_unpack_settings *settings, const char *path,
                            const olx_progress *progress, olx_packed_info *info) {
  field_unpacker u = {.unpacker_count = olx_packed_threads(settings->threads)};
  olx_result result = olx_packed_open(packed_path, &u.packed);
  if (result == OLX_OK) result = check_size(&u.packed, settings->most_bytes);
  if (result == OLX_OK) result = unpack_field(&u, path, progress);
  if (result == OLX_OK && info) *info = olx_packed_info_of(&u.packed);
  olx_packed_close(&u.packed);
  return result;
}
