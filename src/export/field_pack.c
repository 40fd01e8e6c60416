// Packs a field: each block of each chunk with the filter after which zstd compresses it best. Blocks are independent,
// so that the result is the same for any number of threads.
#include "core/hooks.h"
#include "core/parallel.h"
#include "core/result.h"
#include "export/block_filter.h"
#include "export/packed_format.h"
#include "export/running_hash.h"

#include <string.h>
#include <zstd.h>

enum { MOST_LEVEL = 22, TRIAL_LEVEL = 3 };

// The working state of one thread that packs blocks.
typedef struct block_packer {
  ZSTD_CCtx *context;
  uint8_t *data, *room; // a block, and its filtered form
  uint8_t *packed;      // the smallest result so far
  uint8_t *trial;
  size_t packed_bytes;
  uint32_t filter;
  size_t error; // of zstd
} block_packer;

typedef struct field_packer {
  const olx_field *field;
  uint32_t level, packer_count;
  block_packer *packers;
  olx_output_file output;
  olx_task task;
  uint32_t chunk_count;
  olx_file_chunk table[OLX_CHUNK_MAX_COUNT];
  uint64_t end; // end of the data written

  // The chunk being packed.
  const uint8_t *source;
  uint64_t source_bytes, first_block; // size of the chunk, and the index of the block that packers[0] packs
  uint32_t element_bytes;
  uint32_t *words; // one per block of the chunk
  olx_running_hash hash;
} field_packer;

olx_pack_settings olx_pack_settings_default(void) { return (olx_pack_settings){.level = 19}; }

// ---- A block

// Compresses the block into b->trial at that level; returns its size in bytes, 0 when zstd fails.
static size_t pack_by(block_packer *b, const uint8_t *source, size_t size_bytes, uint32_t filter,
                      uint32_t element_bytes, uint32_t level) {
  memcpy(b->data, source, size_bytes);
  const uint8_t *filtered = olx_filter_apply(filter, element_bytes, b->data, b->room, size_bytes);
  ZSTD_CCtx_reset(b->context, ZSTD_reset_session_and_parameters);
  ZSTD_CCtx_setParameter(b->context, ZSTD_c_compressionLevel, (int)level);
  ZSTD_CCtx_setParameter(b->context, ZSTD_c_contentSizeFlag, 0);
  const size_t packed = ZSTD_compress2(b->context, b->trial, OLX_PACKED_MOST_BLOCK_BYTES, filtered, size_bytes);
  if (!ZSTD_isError(packed)) return packed;
  b->error = packed;
  return 0;
}

// The filters that are tried. Colour bits alone, and with differences alone, always lose to the combinations listed
// here.
static const uint32_t filters[] = {0,
                                   OLX_FILTER_PLANES,
                                   OLX_FILTER_DIFFERENCES,
                                   OLX_FILTER_DIFFERENCES | OLX_FILTER_PLANES,
                                   OLX_FILTER_COLORS | OLX_FILTER_PLANES,
                                   OLX_FILTER_COLORS | OLX_FILTER_DIFFERENCES | OLX_FILTER_PLANES};
enum { FILTER_COUNT = sizeof filters / sizeof *filters, FINALISTS = 2 };

// Finds the filters after which the block is smallest at a fast level, best first; UINT32_MAX where there are fewer.
static void find_finalists(block_packer *b, const uint8_t *source, size_t size_bytes, uint32_t element_bytes,
                           uint32_t finalists[FINALISTS]) {
  size_t sizes[FINALISTS];
  for (int i = 0; i < FINALISTS; i++) sizes[i] = SIZE_MAX, finalists[i] = UINT32_MAX;
  for (int k = 0; k < FILTER_COUNT; k++) {
    if (!olx_filter_exists(filters[k], element_bytes)) continue;
    const size_t size = pack_by(b, source, size_bytes, filters[k], element_bytes, TRIAL_LEVEL);
    if (size >= sizes[1]) continue;
    const int place = size < sizes[0] ? 0 : 1;
    if (place == 0) sizes[1] = sizes[0], finalists[1] = finalists[0];
    sizes[place] = size;
    finalists[place] = filters[k];
  }
}

static void pack_block(void *user, uint32_t index) {
  const field_packer *p = user;
  block_packer *b = &p->packers[index];
  const uint64_t block = p->first_block + index;
  const uint8_t *source = p->source + block * OLX_PACKED_BLOCK_BYTES;
  const size_t size_bytes = olx_packed_block_bytes(p->source_bytes, block);
  uint32_t finalists[FINALISTS];
  find_finalists(b, source, size_bytes, p->element_bytes, finalists);
  b->packed_bytes = SIZE_MAX;
  for (int i = 0; i < FINALISTS && finalists[i] != UINT32_MAX; i++) {
    const size_t size = pack_by(b, source, size_bytes, finalists[i], p->element_bytes, p->level);
    if (size >= b->packed_bytes) continue;
    uint8_t *packed = b->trial;
    b->trial = b->packed;
    b->packed = packed;
    b->packed_bytes = size;
    b->filter = finalists[i];
  }
}

// ---- A chunk

static olx_result append(field_packer *p, const void *data, size_t size_bytes) {
  OLX_TRY(olx_output_write_at(&p->output, p->end, data, size_bytes));
  olx_hash_add(&p->hash, data, size_bytes);
  p->end += size_bytes;
  return OLX_OK;
}

static olx_result append_blocks(field_packer *p, uint32_t count) {
  for (uint32_t i = 0; i < count; i++) {
    const block_packer *b = &p->packers[i];
    if (b->error) return olx_fail(OLX_ERROR_MEMORY, "%s: zstd: %s", p->field->name, ZSTD_getErrorName(b->error));
    p->words[p->first_block + i] = (uint32_t)b->packed_bytes | b->filter << OLX_PACKED_FILTER_SHIFT;
    OLX_TRY(append(p, b->packed, b->packed_bytes));
  }
  return OLX_OK;
}

static olx_result pack_blocks(field_packer *p, uint64_t blocks) {
  for (p->first_block = 0; p->first_block < blocks; p->first_block += p->packer_count) {
    const uint64_t left = blocks - p->first_block;
    const uint32_t count = left < p->packer_count ? (uint32_t)left : p->packer_count;
    OLX_TRY(olx_parallel_for(count, p->packer_count, pack_block, p, &p->task, 1));
    OLX_TRY(append_blocks(p, count));
  }
  return append(p, p->words, blocks * sizeof *p->words);
}

// Pads the chunk that was written, and begins the next.
static olx_result finish_chunk(field_packer *p, uint32_t index, olx_file_chunk chunk) {
  static const char padding[OLX_CHUNK_ALIGNMENT];
  chunk.size_bytes = p->end - chunk.offset;
  chunk.hash = olx_hash_end(&p->hash);
  p->table[index] = chunk;
  OLX_TRY(olx_output_write_at(&p->output, p->end, padding, olx_align_chunk(p->end) - p->end));
  p->end = olx_align_chunk(p->end);
  return OLX_OK;
}

// Returns the unit that filters work on in bytes: a texel or a number.
static uint32_t filter_element(uint32_t element_bytes) {
  return element_bytes == 1 || element_bytes == 2 || element_bytes == 4 || element_bytes == 8 ? element_bytes
         : element_bytes % 4 == 0                                                             ? 4
                                                                                              : 1;
}

static olx_result pack_chunk(field_packer *p, uint32_t index) {
  const olx_chunk_file file = olx_field_file(p->field);
  const olx_file_chunk *field = &olx_chunk_table(&file)[index];
  const uint64_t blocks = olx_packed_blocks(field->size_bytes);
  OLX_TRY(olx_chunk_check_content(&file, index));
  p->source = (const uint8_t *)file.data + field->offset;
  p->source_bytes = field->size_bytes;
  p->element_bytes = filter_element(field->element_bytes);
  const olx_file_chunk chunk = {
      .type = field->type, .offset = p->end, .record_bytes = OLX_PACKED_BLOCK_BYTES, .element_bytes = p->element_bytes};
  p->words = olx_allocate(blocks, sizeof *p->words);
  if (!p->words) return olx_fail(OLX_ERROR_MEMORY, "%s: out of memory", p->field->name);
  olx_hash_begin(&p->hash);
  const olx_result result = pack_blocks(p, blocks);
  olx_release(p->words);
  return result == OLX_OK ? finish_chunk(p, index + 1, chunk) : result;
}

// Stores the header and the chunk table of the field unchanged.
static olx_result pack_table(field_packer *p) {
  const size_t size_bytes = sizeof(olx_file_header) + p->chunk_count * sizeof(olx_file_chunk);
  const olx_file_chunk chunk = {
      .type = OLX_PACKED_TABLE, .offset = p->end, .record_bytes = size_bytes, .element_bytes = 64};
  olx_hash_begin(&p->hash);
  OLX_TRY(append(p, p->field->data, size_bytes));
  return finish_chunk(p, 0, chunk);
}

// ---- The file

static olx_result pack_chunks(field_packer *p) {
  const uint32_t count = p->chunk_count + 1;
  p->end = sizeof(olx_file_header) + count * sizeof(olx_file_chunk);
  OLX_TRY(pack_table(p));
  for (uint32_t i = 0; i < p->chunk_count; i++) OLX_TRY(pack_chunk(p, i));
  const olx_file_header header = olx_chunk_header(&OLX_PACKED_KIND, p->table, count, p->end);
  OLX_TRY(olx_output_write_at(&p->output, 0, &header, sizeof header));
  return olx_output_write_at(&p->output, sizeof header, p->table, count * sizeof *p->table);
}

static olx_result write_output(field_packer *p, const char *path) {
  OLX_TRY(olx_output_open(path, &p->output));
  const olx_result result = pack_chunks(p);
  if (result == OLX_OK) return olx_output_commit(&p->output);
  olx_output_discard(&p->output);
  return result;
}

static bool allocate_packer(block_packer *b) {
  b->context = ZSTD_createCCtx();
  b->data = olx_allocate(OLX_PACKED_BLOCK_BYTES, 1);
  b->room = olx_allocate(OLX_PACKED_BLOCK_BYTES, 1);
  b->packed = olx_allocate(OLX_PACKED_MOST_BLOCK_BYTES, 1);
  b->trial = olx_allocate(OLX_PACKED_MOST_BLOCK_BYTES, 1);
  return b->context && b->data && b->room && b->packed && b->trial;
}

static void release_packers(field_packer *p) {
  for (uint32_t i = 0; p->packers && i < p->packer_count; i++) {
    block_packer *b = &p->packers[i];
    ZSTD_freeCCtx(b->context);
    olx_release(b->data);
    olx_release(b->room);
    olx_release(b->packed);
    olx_release(b->trial);
  }
  olx_release(p->packers);
}

static bool allocate_packers(field_packer *p) {
  p->packers = olx_allocate_zero(p->packer_count, sizeof *p->packers);
  bool all = p->packers != NULL;
  for (uint32_t i = 0; all && i < p->packer_count; i++) all = allocate_packer(&p->packers[i]);
  return all;
}

static olx_result pack_field(field_packer *p, const char *path, const olx_progress *progress, uint64_t blocks) {
  olx_result result;
  if (!allocate_packers(p)) {
    result = olx_fail(OLX_ERROR_MEMORY, "%s: out of memory", p->field->name);
  } else {
    olx_task_begin(&p->task, progress, "packing", blocks);
    result = write_output(p, path);
    olx_task_end(&p->task);
  }
  release_packers(p);
  return result;
}

static olx_result check_settings(const olx_pack_settings *settings) {
  if (settings->level >= 1 && settings->level <= MOST_LEVEL) return OLX_OK;
  return olx_fail(OLX_ERROR_ARGUMENT, "level %u is not in 1..%d", settings->level, MOST_LEVEL);
}

olx_result olx_field_pack(const char *field_path, const olx_pack_settings *settings, const char *path,
                          const olx_progress *progress, olx_packed_info *info) {
  olx_field *field = NULL;
  OLX_TRY(check_settings(settings));
  OLX_TRY(olx_field_open(field_path, &field));
  const olx_chunk_file file = olx_field_file(field);
  field_packer *p = olx_allocate_zero(1, sizeof *p);
  olx_result result = OLX_OK;
  if (!p) {
    result = olx_fail(OLX_ERROR_MEMORY, "%s: out of memory", field_path);
  } else {
    p->field = field;
    p->level = settings->level;
    p->packer_count = olx_packed_threads(settings->threads);
    p->chunk_count = ((const olx_file_header *)file.data)->chunk_count;
    result = p->chunk_count <= OLX_PACKED_MOST_CHUNKS
                 ? pack_field(p, path, progress, olx_packed_count_blocks(&file))
                 : olx_fail(OLX_ERROR_UNSUPPORTED, "%s: %u chunks; at most %d can be packed", field_path,
                            p->chunk_count, OLX_PACKED_MOST_CHUNKS);
  }
  olx_release(p);
  olx_field_close(field);
  return result == OLX_OK && info ? olx_packed_describe(path, info) : result;
}
