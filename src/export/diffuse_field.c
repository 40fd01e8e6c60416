// Writes the part of a field that diffuse light needs, compressed by gzip, for pages without reflections
// (docs/web.md, "Without reflections").
#include "core/result.h"
#include "export/gzip_file.h"
#include "field/field_file.h"

#include <octalux/export.h>

// What olx_surface_irradiance and olx_volume_irradiance read, and the origin.
static const uint32_t kept_types[] = {
    OLX_FOUR_CC('I', 'N', 'F', 'O'), OLX_FOUR_CC('P', 'P', 'O', 'S'), OLX_FOUR_CC('P', 'F', 'L', 'G'),
    OLX_FOUR_CC('N', 'O', 'R', 'M'), OLX_FOUR_CC('D', 'I', 'S', 'T'), OLX_FOUR_CC('G', 'E', 'O', 'M'),
    OLX_FOUR_CC('P', 'L', 'A', 'N'), OLX_FOUR_CC('T', 'I', 'N', 'D'), OLX_FOUR_CC('P', 'I', 'N', 'D'),
    OLX_FOUR_CC('I', 'N', 'D', 'I'), OLX_FOUR_CC('B', 'R', 'I', 'K'), OLX_FOUR_CC('V', 'O', 'L', 'U'),
    OLX_FOUR_CC('V', 'I', 'R', 'R'), OLX_FOUR_CC('O', 'R', 'I', 'G')};

typedef struct kept_chunks {
  olx_file_chunk table[OLX_CHUNK_MAX_COUNT]; // with the places in the file that is written
  const void *data[OLX_CHUNK_MAX_COUNT];
  uint32_t count;
} kept_chunks;

static bool is_kept(uint32_t type) {
  for (size_t i = 0; i < sizeof kept_types / sizeof kept_types[0]; i++) {
    if (kept_types[i] == type) return true;
  }
  return false;
}

static void choose_chunks(const olx_chunk_file *field, kept_chunks *kept) {
  const olx_file_header *header = field->data;
  const olx_file_chunk *table = olx_chunk_table(field);
  for (uint32_t i = 0; i < header->chunk_count; i++) {
    if (!is_kept(table[i].type)) continue;
    kept->data[kept->count] = (const char *)field->data + table[i].offset;
    kept->table[kept->count++] = table[i];
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

static olx_result write_chunks(olx_gzip_file *file, const kept_chunks *kept, uint64_t end) {
  static const uint8_t zeros[OLX_CHUNK_ALIGNMENT];
  const olx_file_header header = olx_chunk_header(&OLX_FIELD_KIND, kept->table, kept->count, end);
  OLX_TRY(olx_gzip_write(file, &header, sizeof header));
  OLX_TRY(olx_gzip_write(file, kept->table, kept->count * sizeof kept->table[0]));
  for (uint32_t i = 0; i < kept->count; i++) {
    const uint64_t size = kept->table[i].size_bytes;
    OLX_TRY(olx_gzip_write(file, kept->data[i], size));
    OLX_TRY(olx_gzip_write(file, zeros, olx_align_chunk(size) - size));
  }
  return OLX_OK;
}

olx_result olx_export_diffuse_gzip(const olx_field *field, const char *path, uint64_t *file_bytes) {
  const olx_chunk_file from = olx_field_file(field);
  kept_chunks kept = {.count = 0};
  choose_chunks(&from, &kept);
  const uint64_t end = place_chunks(&kept);
  olx_gzip_file file;
  OLX_TRY(olx_gzip_create(path, &file));
  olx_result result = write_chunks(&file, &kept, end);
  if (result == OLX_OK) result = olx_gzip_commit(&file, file_bytes);
  olx_gzip_discard(&file);
  return result;
}
