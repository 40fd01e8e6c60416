// Writes the part of a field that diffuse light needs, compressed by gzip, for pages without reflections
// (docs/web.md, "What a page loads").
#include "core/hooks.h"
#include "core/result.h"
#include "export/block_filter.h"
#include "export/gzip_file.h"
#include "field/field_file.h"

#include <octalux/export.h>

#include <string.h>

// A chunk's entry in the table holds its filter in the flags from this bit on, and the size of the filter's elements in
// the word that is 0 in fields.
enum { FILTER_SHIFT = 8 };

// A kind of chunk that pages load, and the filter of docs/format.md ("Packed fields") after which gzip leaves least of
// it. Elements of 16 bytes are blocks.
typedef struct kept_kind {
  uint32_t type, filter, element_bytes;
} kept_kind;

// What olx_surface_irradiance and olx_volume_irradiance read, and the origin.
static const kept_kind kept_kinds[] = {{OLX_FOUR_CC('I', 'N', 'F', 'O'), 0, 0},
                                       {OLX_FOUR_CC('P', 'P', 'O', 'S'), 0, 0},
                                       {OLX_FOUR_CC('P', 'F', 'L', 'G'), 0, 0},
                                       {OLX_FOUR_CC('N', 'O', 'R', 'M'), OLX_FILTER_DIFFERENCES | OLX_FILTER_PLANES, 2},
                                       {OLX_FOUR_CC('D', 'I', 'S', 'T'), OLX_FILTER_DIFFERENCES | OLX_FILTER_PLANES, 2},
                                       {OLX_FOUR_CC('G', 'E', 'O', 'M'), OLX_FILTER_PLANES, 16},
                                       {OLX_FOUR_CC('P', 'L', 'A', 'N'), OLX_FILTER_PLANES, 8},
                                       {OLX_FOUR_CC('T', 'I', 'N', 'D'), OLX_FILTER_DIFFERENCES | OLX_FILTER_PLANES, 4},
                                       {OLX_FOUR_CC('P', 'I', 'N', 'D'), OLX_FILTER_PLANES, 16},
                                       {OLX_FOUR_CC('I', 'N', 'D', 'I'), OLX_FILTER_PLANES, 4},
                                       {OLX_FOUR_CC('B', 'R', 'I', 'K'), OLX_FILTER_PLANES, 2},
                                       {OLX_FOUR_CC('V', 'O', 'L', 'U'), OLX_FILTER_DIFFERENCES | OLX_FILTER_PLANES, 4},
                                       {OLX_FOUR_CC('V', 'I', 'R', 'R'), OLX_FILTER_DIFFERENCES | OLX_FILTER_PLANES, 2},
                                       {OLX_FOUR_CC('O', 'R', 'I', 'G'), 0, 0}};

typedef struct kept_chunks {
  olx_file_chunk table[OLX_CHUNK_MAX_COUNT]; // with the places in the file that is written
  const void *data[OLX_CHUNK_MAX_COUNT];
  uint32_t count;
  uint64_t most_bytes;         // size of the largest chunk
  uint8_t *filtered, *another; // that many bytes each, for filters
} kept_chunks;

static const kept_kind *find_kind(uint32_t type) {
  for (size_t i = 0; i < sizeof kept_kinds / sizeof kept_kinds[0]; i++) {
    if (kept_kinds[i].type == type) return &kept_kinds[i];
  }
  return NULL;
}

static void choose_chunks(const olx_chunk_file *field, kept_chunks *kept) {
  const olx_file_header *header = field->data;
  const olx_file_chunk *table = olx_chunk_table(field);
  for (uint32_t i = 0; i < header->chunk_count; i++) {
    const kept_kind *kind = find_kind(table[i].type);
    if (!kind) continue;
    olx_file_chunk *entry = &kept->table[kept->count];
    *entry = table[i];
    entry->flags |= kind->filter << FILTER_SHIFT;
    entry->zero_a = kind->element_bytes;
    kept->data[kept->count++] = (const char *)field->data + table[i].offset;
    if (entry->size_bytes > kept->most_bytes) kept->most_bytes = entry->size_bytes;
  }
}

// Computes the chunks' new places; returns where the last of them ends, with its padding.
static uint64_t place_chunks(kept_chunks *kept) {
  uint64_t end = sizeof(olx_file_header) + kept->count * sizeof(olx_file_chunk);
  for (uint32_t i = 0; i < kept->count; i++) {
    kept->table[i].offset = end;
    end = olx_align_chunk(end + kept->table[i].size_bytes);
  }
  return end;
}

static const uint8_t *filter_chunk(const kept_chunks *kept, uint32_t i) {
  const olx_file_chunk *entry = &kept->table[i];
  memcpy(kept->filtered, kept->data[i], entry->size_bytes);
  return olx_filter_apply(entry->flags >> FILTER_SHIFT, entry->zero_a, kept->filtered, kept->another,
                          entry->size_bytes);
}

static olx_result write_chunks(olx_gzip_file *file, const kept_chunks *kept, uint64_t end) {
  static const uint8_t zeros[OLX_CHUNK_ALIGNMENT];
  const olx_file_header header = olx_chunk_header(&OLX_FIELD_KIND, kept->table, kept->count, end);
  OLX_TRY(olx_gzip_write(file, &header, sizeof header));
  OLX_TRY(olx_gzip_write(file, kept->table, kept->count * sizeof kept->table[0]));
  for (uint32_t i = 0; i < kept->count; i++) {
    const uint64_t size = kept->table[i].size_bytes;
    OLX_TRY(olx_gzip_write(file, filter_chunk(kept, i), size));
    OLX_TRY(olx_gzip_write(file, zeros, olx_align_chunk(size) - size));
  }
  return OLX_OK;
}

static olx_result write_field(const kept_chunks *kept, uint64_t end, const char *path, uint64_t *file_bytes) {
  olx_gzip_file file;
  OLX_TRY(olx_gzip_create(path, &file));
  olx_result result = write_chunks(&file, kept, end);
  if (result == OLX_OK) result = olx_gzip_commit(&file, file_bytes);
  olx_gzip_discard(&file);
  return result;
}

olx_result olx_export_diffuse_gzip(const olx_field *field, const char *path, uint64_t *file_bytes) {
  const olx_chunk_file from = olx_field_file(field);
  kept_chunks kept = {.count = 0};
  choose_chunks(&from, &kept);
  const uint64_t end = place_chunks(&kept);
  kept.filtered = olx_allocate(kept.most_bytes, 1);
  kept.another = olx_allocate(kept.most_bytes, 1);
  const olx_result result = kept.filtered && kept.another ? write_field(&kept, end, path, file_bytes)
                                                          : olx_fail(OLX_ERROR_MEMORY, "%s: out of memory", path);
  olx_release(kept.filtered);
  olx_release(kept.another);
  return result;
}
