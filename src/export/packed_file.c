// Opens packed fields: checks the header and the tables, and that both tables name the same chunks.
#include "core/parallel.h"
#include "core/result.h"
#include "export/packed_format.h"

#include <string.h>

static olx_result check_kind(const olx_chunk_file *file) {
  const size_t magic_bytes = sizeof OLX_FIELD_MAGIC - 1;
  if (file->size_bytes < magic_bytes || memcmp(file->data, OLX_FIELD_MAGIC, magic_bytes) != 0) {
    return olx_chunk_file_check(file, &OLX_PACKED_KIND);
  }
  return olx_fail(OLX_ERROR_FORMAT, "%s: a field that is not packed", file->name);
}

// Locates the field's header and chunk table, which the first chunk holds unchanged.
static olx_result find_field_table(olx_packed_file *packed) {
  const olx_file_chunk *chunk = olx_chunk_table(&packed->file);
  const olx_file_header *header = (const void *)((const char *)packed->file.data + chunk->offset);
  const char *name = packed->file.name;
  if (chunk->type != OLX_PACKED_TABLE || chunk->size_bytes < sizeof(olx_file_header) ||
      chunk->size_bytes != sizeof(olx_file_header) + header->chunk_count * (uint64_t)sizeof(olx_file_chunk)) {
    return olx_fail(OLX_ERROR_FORMAT, "%s: the first chunk is not the header and the chunk table of a field", name);
  }
  OLX_TRY(olx_chunk_check_content(&packed->file, 0));
  packed->field = (olx_chunk_file){.data = header, .size_bytes = header->file_bytes, .name = name};
  OLX_TRY(olx_chunk_file_check(&packed->field, &OLX_FIELD_KIND));
  packed->chunk_count = header->chunk_count;
  const uint32_t found = ((const olx_file_header *)packed->file.data)->chunk_count;
  if (found == packed->chunk_count + 1) return OLX_OK;
  return olx_fail(OLX_ERROR_FORMAT, "%s: %u packed chunks where the field has %u", name, found - 1,
                  packed->chunk_count);
}

// Checks a chunk. Every block takes some packed bytes, which bounds the unpacked size that a packed file can claim.
static olx_result check_chunk(const olx_packed_file *packed, uint32_t index) {
  const olx_file_chunk *field = olx_packed_field_chunk(packed, index), *chunk = olx_packed_chunk_of(packed, index);
  const olx_chunk_name type = olx_chunk_type_name(field->type);
  const char *name = packed->file.name;
  const uint64_t blocks = olx_packed_blocks(field->size_bytes);
  if (chunk->type != field->type) {
    return olx_fail(OLX_ERROR_FORMAT, "%s: packed chunk %u is %s where the field has %s", name, index,
                    olx_chunk_type_name(chunk->type).text, type.text);
  }
  const uint32_t element = chunk->element_bytes;
  if (chunk->record_bytes != OLX_PACKED_BLOCK_BYTES || chunk->flags ||
      (element != 1 && element != 2 && element != 4 && element != 8)) {
    return olx_fail(OLX_ERROR_FORMAT, "%s: chunk %s: blocks of %llu bytes in elements of %u, or flags", name, type.text,
                    (unsigned long long)chunk->record_bytes, element);
  }
  if (blocks == 0 ? chunk->size_bytes == 0 : chunk->size_bytes / (sizeof(uint32_t) + 1) >= blocks) return OLX_OK;
  return olx_fail(OLX_ERROR_FORMAT, "%s: chunk %s: %llu bytes cannot hold %llu blocks", name, type.text,
                  (unsigned long long)chunk->size_bytes, (unsigned long long)blocks);
}

static olx_result check_packed(olx_packed_file *packed) {
  OLX_TRY(check_kind(&packed->file));
  OLX_TRY(find_field_table(packed));
  for (uint32_t i = 0; i < packed->chunk_count; i++) OLX_TRY(check_chunk(packed, i));
  return OLX_OK;
}

olx_result olx_packed_open(const char *path, olx_packed_file *packed) {
  *packed = (olx_packed_file){0};
  OLX_TRY(olx_map_file(path, &packed->mapped));
  packed->file = (olx_chunk_file){.data = packed->mapped.data, .size_bytes = packed->mapped.size_bytes, .name = path};
  return check_packed(packed);
}

void olx_packed_close(olx_packed_file *packed) { olx_unmap_file(&packed->mapped); }

uint64_t olx_packed_count_blocks(const olx_chunk_file *field) {
  const uint32_t count = ((const olx_file_header *)field->data)->chunk_count;
  uint64_t blocks = 0;
  for (uint32_t i = 0; i < count; i++) blocks += olx_packed_blocks(olx_chunk_table(field)[i].size_bytes);
  return blocks;
}

uint32_t olx_packed_threads(uint32_t threads) {
  const uint32_t wanted = threads ? threads : olx_processor_count();
  return wanted < OLX_PACKED_MOST_THREADS ? wanted : OLX_PACKED_MOST_THREADS;
}

olx_packed_info olx_packed_info_of(const olx_packed_file *packed) {
  olx_packed_info info = {.field_bytes = packed->field.size_bytes,
                          .packed_bytes = packed->file.size_bytes,
                          .chunk_count = packed->chunk_count};
  for (uint32_t i = 0; i < packed->chunk_count; i++) {
    const olx_file_chunk *field = olx_packed_field_chunk(packed, i);
    memcpy(info.chunks[i].type, olx_chunk_type_name(field->type).text, sizeof info.chunks[i].type);
    info.chunks[i].field_bytes = field->size_bytes;
    info.chunks[i].packed_bytes = olx_packed_chunk_of(packed, i)->size_bytes;
  }
  return info;
}

olx_result olx_packed_describe(const char *path, olx_packed_info *info) {
  olx_packed_file packed;
  const olx_result result = olx_packed_open(path, &packed);
  if (result == OLX_OK) *info = olx_packed_info_of(&packed);
  olx_packed_close(&packed);
  return result;
}

bool olx_is_packed_field(const char *path) {
  olx_mapped_file file;
  if (olx_map_file(path, &file) != OLX_OK) return false;
  const size_t magic_bytes = sizeof OLX_PACKED_MAGIC - 1;
  const bool is = file.size_bytes >= magic_bytes && memcmp(file.data, OLX_PACKED_MAGIC, magic_bytes) == 0;
  olx_unmap_file(&file);
  return is;
}
