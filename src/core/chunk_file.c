// Reads, checks and writes the frame that Octalux's binary files share: a header and a table of chunks, in which every
// byte is covered by a checksum or required to be zero.
#include "core/chunk_file.h"

#include "core/file.h"
#include "core/parallel.h"
#include "core/result.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#define XXH_INLINE_ALL
#define XXH_FORCE_MEMORY_ACCESS                                                                                        \
  0 // by memcpy: its other ways read structures as numbers, which breaks the rules of strict aliasing
#include <xxhash.h>

uint64_t olx_content_hash(const void *data, size_t size_bytes) { return XXH3_64bits(data, size_bytes); }

olx_chunk_name olx_chunk_type_name(uint32_t type) {
  olx_chunk_name name = {{0}};
  for (uint32_t i = 0; i < 4; i++) {
    const uint32_t c = type >> 8 * i & 0xFFu;
    name.text[i] = (char)(c > 32 && c < 127 ? c : '?');
  }
  return name;
}

static olx_result check_header(const olx_chunk_file *file, const olx_file_kind *kind) {
  if (file->size_bytes < sizeof(olx_file_header)) {
    return olx_fail(OLX_ERROR_FORMAT, "%s: %zu bytes are too short for a %s", file->name, file->size_bytes, kind->noun);
  }
  const olx_file_header *header = file->data;
  if (memcmp(header->magic, kind->magic, sizeof header->magic) != 0) {
    return olx_fail(OLX_ERROR_FORMAT, "%s: not a %s (wrong magic)", file->name, kind->noun);
  }
  if (header->version != kind->version) {
    const bool older = header->version < kind->version;
    return olx_fail(OLX_ERROR_VERSION, "%s: format version %u is %s than the %u this library reads%s", file->name,
                    header->version, older ? "older" : "newer", kind->version, older ? kind->remedy : "");
  }
  if (!olx_checksum_holds(olx_content_hash(header, offsetof(olx_file_header, header_hash)), header->header_hash)) {
    return olx_fail(OLX_ERROR_CHECKSUM, "%s: header: wrong checksum", file->name);
  }
  if (header->file_bytes != file->size_bytes) {
    return olx_fail(OLX_ERROR_FORMAT, "%s: %s: %zu bytes where the header says %llu", file->name,
                    file->size_bytes < header->file_bytes ? "truncated" : "too long", file->size_bytes,
                    (unsigned long long)header->file_bytes);
  }
  if (header->zero[0] || header->zero[1] || header->zero[2]) {
    return olx_fail(OLX_ERROR_FORMAT, "%s: header: reserved bytes are not zero", file->name);
  }
  if (header->chunk_count < 1 || header->chunk_count > OLX_CHUNK_MAX_COUNT) {
    return olx_fail(OLX_ERROR_FORMAT, "%s: header: %u chunks are not in 1..%d", file->name, header->chunk_count,
                    OLX_CHUNK_MAX_COUNT);
  }
  const size_t table_bytes = header->chunk_count * sizeof(olx_file_chunk);
  if (table_bytes > file->size_bytes - sizeof *header) {
    return olx_fail(OLX_ERROR_FORMAT, "%s: truncated inside the chunk table", file->name);
  }
  if (!olx_checksum_holds(olx_content_hash(header + 1, table_bytes), header->table_hash)) {
    return olx_fail(OLX_ERROR_CHECKSUM, "%s: chunk table: wrong checksum", file->name);
  }
  return OLX_OK;
}

// Checks the table. Chunks follow each other without gaps except for alignment, so none can overlap or hide bytes.
static olx_result check_table(const olx_chunk_file *file) {
  const olx_file_header *header = file->data;
  const olx_file_chunk *table = olx_chunk_table(file);
  uint64_t end = sizeof *header + header->chunk_count * sizeof *table;
  for (uint32_t i = 0; i < header->chunk_count; i++) {
    const olx_file_chunk *chunk = &table[i];
    const olx_chunk_name type = olx_chunk_type_name(chunk->type);
    if ((chunk->flags & ~(uint32_t)OLX_CHUNK_OPTIONAL) || chunk->zero_a || chunk->zero_b[0] || chunk->zero_b[1]) {
      return olx_fail(OLX_ERROR_FORMAT, "%s: chunk %u (%s): unknown flags or reserved bytes that are not zero",
                      file->name, i, type.text);
    }
    if (chunk->offset != end) {
      return olx_fail(OLX_ERROR_FORMAT, "%s: chunk %u (%s): begins at byte %llu, not at %llu where it must", file->name,
                      i, type.text, (unsigned long long)chunk->offset, (unsigned long long)end);
    }
    if (chunk->size_bytes > file->size_bytes - chunk->offset) {
      return olx_fail(OLX_ERROR_FORMAT, "%s: chunk %u (%s): %llu bytes at byte %llu reach beyond the end of the file",
                      file->name, i, type.text, (unsigned long long)chunk->size_bytes,
                      (unsigned long long)chunk->offset);
    }
    end = olx_align_chunk(chunk->offset + chunk->size_bytes);
    if (end > file->size_bytes) {
      return olx_fail(OLX_ERROR_FORMAT, "%s: chunk %u (%s): its padding reaches beyond the end of the file", file->name,
                      i, type.text);
    }
  }
  if (end != file->size_bytes) {
    return olx_fail(OLX_ERROR_FORMAT, "%s: %llu bytes after the last chunk", file->name,
                    (unsigned long long)(file->size_bytes - end));
  }
  return OLX_OK;
}

olx_result olx_chunk_file_check(const olx_chunk_file *file, const olx_file_kind *kind) {
  OLX_TRY(check_header(file, kind));
  return check_table(file);
}

olx_result olx_chunk_find_any(const olx_chunk_file *file, uint32_t type, const olx_file_chunk **found) {
  const olx_file_header *header = file->data;
  const olx_file_chunk *table = olx_chunk_table(file);
  *found = NULL;
  for (uint32_t i = 0; i < header->chunk_count; i++) {
    if (table[i].type != type) continue;
    if (*found) return olx_fail(OLX_ERROR_FORMAT, "%s: two chunks %s", file->name, olx_chunk_type_name(type).text);
    *found = &table[i];
  }
  return OLX_OK;
}

olx_result olx_chunk_find_optional(const olx_chunk_file *file, uint32_t type, const olx_file_chunk **found) {
  OLX_TRY(olx_chunk_find_any(file, type, found));
  if (!*found || (*found)->flags == OLX_CHUNK_OPTIONAL) return OLX_OK;
  return olx_fail(OLX_ERROR_FORMAT, "%s: chunk %s: not flagged optional, but it is", file->name,
                  olx_chunk_type_name(type).text);
}

olx_result olx_chunk_find(const olx_chunk_file *file, uint32_t type, const olx_file_chunk **found) {
  OLX_TRY(olx_chunk_find_any(file, type, found));
  if (!*found) return olx_fail(OLX_ERROR_FORMAT, "%s: no chunk %s", file->name, olx_chunk_type_name(type).text);
  return OLX_OK;
}

static olx_result check_shape(const olx_chunk_file *file, const olx_file_chunk *chunk, const olx_chunk_shape *shape,
                              const void **data) {
  const olx_chunk_name type = olx_chunk_type_name(shape->type);
  if (chunk->element_bytes != shape->element_bytes || chunk->record_bytes != shape->record_bytes ||
      chunk->size_bytes != shape->size_bytes) {
    return olx_fail(OLX_ERROR_FORMAT,
                    "%s: chunk %s: %llu bytes in records of %llu and elements of %u, where the description asks for "
                    "%llu, %llu and %u",
                    file->name, type.text, (unsigned long long)chunk->size_bytes,
                    (unsigned long long)chunk->record_bytes, chunk->element_bytes,
                    (unsigned long long)shape->size_bytes, (unsigned long long)shape->record_bytes,
                    shape->element_bytes);
  }
  *data = (const char *)file->data + chunk->offset;
  return OLX_OK;
}

olx_result olx_chunk_find_shaped(const olx_chunk_file *file, const olx_chunk_shape *shape, const void **data) {
  const olx_file_chunk *chunk;
  OLX_TRY(olx_chunk_find(file, shape->type, &chunk));
  if (chunk->flags == 0) return check_shape(file, chunk, shape, data);
  return olx_fail(OLX_ERROR_FORMAT, "%s: chunk %s: flagged optional, but it is not", file->name,
                  olx_chunk_type_name(shape->type).text);
}

olx_result olx_chunk_find_optional_shaped(const olx_chunk_file *file, const olx_chunk_shape *shape, const void **data) {
  const olx_file_chunk *chunk;
  *data = NULL;
  OLX_TRY(olx_chunk_find_optional(file, shape->type, &chunk));
  return chunk ? check_shape(file, chunk, shape, data) : OLX_OK;
}

olx_result olx_chunk_find_bytes(const olx_chunk_file *file, uint32_t type, const olx_file_chunk **found) {
  const void *data;
  OLX_TRY(olx_chunk_find_optional(file, type, found));
  if (!*found) return OLX_OK;
  const olx_chunk_row row = {.type = type, .element_bytes = 1, .elements = (*found)->size_bytes, .records = 1};
  const olx_chunk_shape shape = olx_chunk_shape_of(&row);
  return check_shape(file, *found, &shape, &data);
}

olx_result olx_chunk_find_header(const olx_chunk_file *file, const olx_chunk_shape *shape, const void **data) {
  const olx_file_chunk *chunk;
  OLX_TRY(olx_chunk_find_optional_shaped(file, shape, data));
  if (!*data) return OLX_OK;
  OLX_TRY(olx_chunk_find_optional(file, shape->type, &chunk));
  if (olx_checksum_holds(olx_content_hash(*data, shape->size_bytes), chunk->hash)) return OLX_OK;
  return olx_fail(OLX_ERROR_CHECKSUM, "%s: chunk %s: wrong checksum", file->name,
                  olx_chunk_type_name(shape->type).text);
}

olx_result olx_chunk_find_wanted(const olx_chunk_file *file, const olx_chunk_shape *shape, uint32_t header, bool wanted,
                                 const void **data) {
  const olx_file_chunk *chunk;
  OLX_TRY(olx_chunk_find_optional(file, shape->type, &chunk));
  if ((chunk != NULL) == wanted) return wanted ? olx_chunk_find_optional_shaped(file, shape, data) : OLX_OK;
  const olx_chunk_name name = olx_chunk_type_name(shape->type), heading = olx_chunk_type_name(header);
  return wanted ? olx_fail(OLX_ERROR_FORMAT, "%s: no chunk %s, but chunk %s speaks of it", file->name, name.text,
                           heading.text)
                : olx_fail(OLX_ERROR_FORMAT, "%s: a chunk %s, but no chunk %s that speaks of it", file->name, name.text,
                           heading.text);
}

bool olx_origin_is_stored(const double origin[3]) { return origin[0] != 0.0 || origin[1] != 0.0 || origin[2] != 0.0; }

olx_result olx_chunk_find_origin(const olx_chunk_file *file, double origin[3]) {
  const olx_chunk_row row = OLX_CHUNK_ORIGIN_ROW;
  const olx_chunk_shape shape = olx_chunk_shape_of(&row);
  const olx_file_chunk *chunk;
  const void *data;
  origin[0] = origin[1] = origin[2] = 0.0;
  OLX_TRY(olx_chunk_find_any(file, shape.type, &chunk));
  if (!chunk) return OLX_OK;
  OLX_TRY(olx_chunk_find_shaped(file, &shape, &data));
  if (!olx_checksum_holds(olx_content_hash(data, shape.size_bytes), chunk->hash)) {
    return olx_fail(OLX_ERROR_CHECKSUM, "%s: chunk ORIG: wrong checksum", file->name);
  }
  memcpy(origin, data, 3 * sizeof *origin);
  bool within = olx_origin_is_stored(origin);
  for (int axis = 0; axis < 3; axis++) within = within && fabs(origin[axis]) <= OLX_POSITION_LIMIT_METRES;
  if (within) return OLX_OK;
  return olx_fail(OLX_ERROR_FORMAT, "%s: chunk ORIG: the origin (%g %g %g) is 0, or not within 2e7 m", file->name,
                  origin[0], origin[1], origin[2]);
}

olx_result olx_chunk_refuse_unknown(const olx_chunk_file *file, const olx_chunk_shape *shapes, uint32_t count) {
  const olx_file_header *header = file->data;
  const olx_file_chunk *table = olx_chunk_table(file);
  const olx_chunk_row origin = OLX_CHUNK_ORIGIN_ROW;
  for (uint32_t i = 0; i < header->chunk_count; i++) {
    bool known = (table[i].flags & OLX_CHUNK_OPTIONAL) != 0 || table[i].type == origin.type;
    for (uint32_t k = 0; k < count && !known; k++) known = table[i].type == shapes[k].type;
    if (!known) {
      return olx_fail(OLX_ERROR_UNSUPPORTED, "%s: chunk %u (%s) is required, but this version does not know it",
                      file->name, i, olx_chunk_type_name(table[i].type).text);
    }
  }
  return OLX_OK;
}

olx_result olx_chunk_check_content(const olx_chunk_file *file, uint32_t index) {
  const olx_file_chunk *chunk = &olx_chunk_table(file)[index];
  const char *data = (const char *)file->data + chunk->offset;
  if (!olx_checksum_holds(olx_content_hash(data, chunk->size_bytes), chunk->hash)) {
    return olx_fail(OLX_ERROR_CHECKSUM, "%s: chunk %u (%s): wrong checksum", file->name, index,
                    olx_chunk_type_name(chunk->type).text);
  }
  for (uint64_t i = chunk->size_bytes; i < olx_align_chunk(chunk->offset + chunk->size_bytes) - chunk->offset; i++) {
    if (data[i] != 0) {
      return olx_fail(OLX_ERROR_FORMAT, "%s: chunk %u (%s): padding at byte %llu is not zero", file->name, index,
                      olx_chunk_type_name(chunk->type).text, (unsigned long long)(chunk->offset + i));
    }
  }
  return OLX_OK;
}

olx_file_chunk olx_chunk_entry(const olx_chunk_shape *shape, uint32_t flags, uint64_t offset, uint64_t hash) {
  return (olx_file_chunk){.type = shape->type,
                          .flags = flags,
                          .offset = offset,
                          .size_bytes = shape->size_bytes,
                          .record_bytes = shape->record_bytes,
                          .element_bytes = shape->element_bytes,
                          .hash = hash};
}

olx_file_header olx_chunk_header(const olx_file_kind *kind, const olx_file_chunk *table, uint32_t count,
                                 uint64_t file_bytes) {
  olx_file_header header = {.version = kind->version, .chunk_count = count, .file_bytes = file_bytes};
  memcpy(header.magic, kind->magic, sizeof header.magic);
  header.table_hash = olx_content_hash(table, count * sizeof *table);
  header.header_hash = olx_content_hash(&header, offsetof(olx_file_header, header_hash));
  return header;
}

static olx_result write_chunks(olx_output_file *file, const olx_chunk_shape *shapes, const void *const *data,
                               uint32_t count) {
  static const char padding[OLX_CHUNK_ALIGNMENT];
  uint64_t end = sizeof(olx_file_header) + count * sizeof(olx_file_chunk);
  for (uint32_t i = 0; i < count; i++) {
    OLX_TRY(olx_check_cancelled());
    OLX_TRY(olx_output_write(file, data[i], shapes[i].size_bytes));
    end += shapes[i].size_bytes;
    OLX_TRY(olx_output_write(file, padding, olx_align_chunk(end) - end));
    end = olx_align_chunk(end);
  }
  return OLX_OK;
}

olx_result olx_chunk_file_write(const char *path, const olx_file_kind *kind, const olx_chunk_shape *shapes,
                                const void *const *data, uint32_t count, uint64_t *file_bytes) {
  assert(count >= 1 && count <= OLX_CHUNK_MAX_COUNT);
  olx_file_chunk table[OLX_CHUNK_MAX_COUNT];
  uint64_t end = sizeof(olx_file_header) + count * sizeof *table;
  for (uint32_t i = 0; i < count; i++) {
    table[i] = olx_chunk_entry(&shapes[i], 0, end, olx_content_hash(data[i], shapes[i].size_bytes));
    end = olx_align_chunk(end + shapes[i].size_bytes);
  }
  const olx_file_header header = olx_chunk_header(kind, table, count, end);
  olx_output_file file;
  OLX_TRY(olx_output_open_in_order(path, &file));
  olx_result result = olx_output_reserve(&file, end);
  if (result == OLX_OK) result = olx_output_write(&file, &header, sizeof header);
  if (result == OLX_OK) result = olx_output_write(&file, table, count * sizeof *table);
  if (result == OLX_OK) result = write_chunks(&file, shapes, data, count);
  if (result != OLX_OK) {
    olx_output_discard(&file);
    return result;
  }
  if (file_bytes) *file_bytes = end;
  return olx_output_commit(&file);
}
