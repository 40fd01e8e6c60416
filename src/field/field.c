#include "core/file.h"
#include "core/hooks.h"
#include "core/result.h"
#include "field/field_file.h"

#include <assert.h>

// Magic and version first: only they are known to mean the same in every version.
static olx_result check_header(const olx_field *field) {
  if (field->size_bytes < sizeof(olx_file_header)) {
    return olx_fail(OLX_ERROR_FORMAT, "%s: %zu bytes are too short for a field file", field->name, field->size_bytes);
  }
  const olx_file_header *header = field->data;
  if (memcmp(header->magic, OLX_FIELD_MAGIC, sizeof header->magic) != 0) {
    return olx_fail(OLX_ERROR_FORMAT, "%s: not a field file (wrong magic)", field->name);
  }
  if (header->version != OLX_FIELD_VERSION) {
    return olx_fail(OLX_ERROR_VERSION, "%s: format version %u is %s than the %d this library reads", field->name,
                    header->version, header->version < OLX_FIELD_VERSION ? "older" : "newer", OLX_FIELD_VERSION);
  }
  if (olx_field_hash(header, offsetof(olx_file_header, header_hash)) != header->header_hash) {
    return olx_fail(OLX_ERROR_CHECKSUM, "%s: header: wrong checksum", field->name);
  }
  if (header->file_bytes != field->size_bytes) {
    return olx_fail(OLX_ERROR_FORMAT, "%s: %s: %zu bytes where the header says %llu", field->name,
                    field->size_bytes < header->file_bytes ? "truncated" : "too long", field->size_bytes,
                    (unsigned long long)header->file_bytes);
  }
  if (header->zero[0] || header->zero[1] || header->zero[2]) {
    return olx_fail(OLX_ERROR_FORMAT, "%s: header: reserved bytes are not zero", field->name);
  }
  if (header->chunk_count < 1 || header->chunk_count > OLX_FIELD_MAX_CHUNKS) {
    return olx_fail(OLX_ERROR_FORMAT, "%s: header: %u chunks are not in 1..%d", field->name, header->chunk_count,
                    OLX_FIELD_MAX_CHUNKS);
  }
  const size_t table_bytes = header->chunk_count * sizeof(olx_file_chunk);
  if (table_bytes > field->size_bytes - sizeof *header) {
    return olx_fail(OLX_ERROR_FORMAT, "%s: truncated inside the chunk table", field->name);
  }
  if (olx_field_hash(header + 1, table_bytes) != header->table_hash) {
    return olx_fail(OLX_ERROR_CHECKSUM, "%s: chunk table: wrong checksum", field->name);
  }
  return OLX_OK;
}

// Chunks follow each other without gaps but for alignment, so none can overlap or hide bytes.
static olx_result check_table(const olx_field *field) {
  const olx_file_header *header = field->data;
  const olx_file_chunk *table = olx_field_chunks(field);
  uint64_t end = sizeof *header + header->chunk_count * sizeof *table;
  for (uint32_t i = 0; i < header->chunk_count; i++) {
    const olx_file_chunk *chunk = &table[i];
    const olx_chunk_name type = olx_chunk_type_name(chunk->type);
    if ((chunk->flags & ~(uint32_t)OLX_CHUNK_OPTIONAL) || chunk->zero_a || chunk->zero_b[0] || chunk->zero_b[1]) {
      return olx_fail(OLX_ERROR_FORMAT, "%s: chunk %u (%s): unknown flags or reserved bytes that are not zero",
                      field->name, i, type.text);
    }
    if (chunk->offset != end) {
      return olx_fail(OLX_ERROR_FORMAT, "%s: chunk %u (%s): begins at byte %llu, not at %llu where it must",
                      field->name, i, type.text, (unsigned long long)chunk->offset, (unsigned long long)end);
    }
    if (chunk->size_bytes > field->size_bytes - chunk->offset) {
      return olx_fail(OLX_ERROR_FORMAT, "%s: chunk %u (%s): %llu bytes at byte %llu reach beyond the end of the file",
                      field->name, i, type.text, (unsigned long long)chunk->size_bytes,
                      (unsigned long long)chunk->offset);
    }
    end = olx_align_chunk(chunk->offset + chunk->size_bytes);
    if (end > field->size_bytes) {
      return olx_fail(OLX_ERROR_FORMAT, "%s: chunk %u (%s): its padding reaches beyond the end of the file",
                      field->name, i, type.text);
    }
  }
  if (end != field->size_bytes) {
    return olx_fail(OLX_ERROR_FORMAT, "%s: %llu bytes after the last chunk", field->name,
                    (unsigned long long)(field->size_bytes - end));
  }
  return OLX_OK;
}

// The one chunk of a type that every reader must find.
static olx_result find_chunk(const olx_field *field, uint32_t type, const olx_file_chunk **found) {
  const olx_file_header *header = field->data;
  const olx_file_chunk *table = olx_field_chunks(field);
  *found = NULL;
  for (uint32_t i = 0; i < header->chunk_count; i++) {
    if (table[i].type != type) continue;
    if (*found) return olx_fail(OLX_ERROR_FORMAT, "%s: two chunks %s", field->name, olx_chunk_type_name(type).text);
    *found = &table[i];
  }
  if (!*found) return olx_fail(OLX_ERROR_FORMAT, "%s: no chunk %s", field->name, olx_chunk_type_name(type).text);
  return OLX_OK;
}

static olx_result find_shaped(const olx_field *field, const olx_chunk_shape *shape, const void **data) {
  const olx_file_chunk *chunk;
  OLX_TRY(find_chunk(field, shape->type, &chunk));
  const olx_chunk_name type = olx_chunk_type_name(shape->type);
  if (chunk->flags != 0) {
    return olx_fail(OLX_ERROR_FORMAT, "%s: chunk %s: flagged optional, but it is not", field->name, type.text);
  }
  if (chunk->element_bytes != shape->element_bytes || chunk->record_bytes != shape->record_bytes ||
      chunk->size_bytes != shape->size_bytes) {
    return olx_fail(OLX_ERROR_FORMAT,
                    "%s: chunk %s: %llu bytes in records of %llu and elements of %u, where the description asks for "
                    "%llu, %llu and %u",
                    field->name, type.text, (unsigned long long)chunk->size_bytes,
                    (unsigned long long)chunk->record_bytes, chunk->element_bytes,
                    (unsigned long long)shape->size_bytes, (unsigned long long)shape->record_bytes,
                    shape->element_bytes);
  }
  *data = (const char *)field->data + chunk->offset;
  return OLX_OK;
}

static olx_result read_info(olx_field *field) {
  const olx_file_chunk *chunk;
  OLX_TRY(find_chunk(field, OLX_FOUR_CC('I', 'N', 'F', 'O'), &chunk));
  if (chunk->size_bytes != sizeof(olx_file_info)) {
    return olx_fail(OLX_ERROR_FORMAT, "%s: chunk INFO: %llu bytes, not %zu", field->name,
                    (unsigned long long)chunk->size_bytes, sizeof(olx_file_info));
  }
  const olx_file_info *stored = (const void *)((const char *)field->data + chunk->offset);
  if (olx_field_hash(stored, sizeof *stored) != chunk->hash) {
    return olx_fail(OLX_ERROR_CHECKSUM, "%s: chunk INFO: wrong checksum", field->name);
  }
  field->info = olx_field_info_load(stored);
  OLX_TRY(olx_field_info_check(&field->info, field->name, OLX_ERROR_FORMAT));
  // What the description holds must be what a writer makes of it: reserved fields zero, flags 0 or 1, the block size of n.
  const olx_file_info again = olx_field_info_store(&field->info);
  if (memcmp(&again, stored, sizeof again) != 0) {
    return olx_fail(OLX_ERROR_FORMAT, "%s: chunk INFO: block size, grid flag, absent grid or reserved bytes are wrong",
                    field->name);
  }
  return OLX_OK;
}

static olx_result refuse_unknown(const olx_field *field, const olx_chunk_shape shapes[OLX_CHUNK_KINDS]) {
  const olx_file_header *header = field->data;
  const olx_file_chunk *table = olx_field_chunks(field);
  for (uint32_t i = 0; i < header->chunk_count; i++) {
    bool known = (table[i].flags & OLX_CHUNK_OPTIONAL) != 0;
    for (uint32_t k = 0; k < OLX_CHUNK_KINDS && !known; k++) known = table[i].type == shapes[k].type;
    if (!known) {
      return olx_fail(OLX_ERROR_UNSUPPORTED, "%s: chunk %u (%s) is required, but this version does not know it",
                      field->name, i, olx_chunk_type_name(table[i].type).text);
    }
  }
  return OLX_OK;
}

static olx_result find_chunks(olx_field *field) {
  olx_chunk_shape shapes[OLX_CHUNK_KINDS];
  const void *data[OLX_CHUNK_KINDS];
  olx_chunk_shapes(&field->info, shapes);
  for (uint32_t k = 0; k < OLX_CHUNK_KINDS; k++) OLX_TRY(find_shaped(field, &shapes[k], &data[k]));
  OLX_TRY(refuse_unknown(field, shapes));
  olx_field_info *info = &field->info;
  info->file_bytes = field->size_bytes;
  info->radiance_bytes = shapes[OLX_CHUNK_RADIANCE].size_bytes;
  info->normal_bytes = shapes[OLX_CHUNK_NORMAL].size_bytes;
  info->distance_bytes = shapes[OLX_CHUNK_DISTANCE].size_bytes;
  info->pyramid_bytes = shapes[OLX_CHUNK_COARSE].size_bytes;
  info->irradiance_bytes = shapes[OLX_CHUNK_IRRADIANCE].size_bytes;
  info->moments_bytes = shapes[OLX_CHUNK_MOMENTS].size_bytes;
  field->probe_positions = data[OLX_CHUNK_PROBE_POSITIONS];
  field->probe_flags = data[OLX_CHUNK_PROBE_FLAGS];
  field->irradiance_positions = data[OLX_CHUNK_IRRADIANCE_POSITIONS];
  field->irradiance_flags = data[OLX_CHUNK_IRRADIANCE_FLAGS];
  field->n = info->radiance_size;
  field->stride = field->n + 2;
  field->texels = (size_t)field->stride * field->stride;
  field->radiance = data[OLX_CHUNK_RADIANCE];
  field->normal = data[OLX_CHUNK_NORMAL];
  field->distance = data[OLX_CHUNK_DISTANCE];
  field->block = olx_block_size(field->n);
  field->coarse_n = field->n / field->block;
  field->coarse = data[OLX_CHUNK_COARSE];
  field->irradiance_n = info->irradiance_size;
  field->irradiance_stride = field->irradiance_n + 2;
  field->irradiance_texels = (size_t)field->irradiance_stride * field->irradiance_stride;
  field->irradiance = data[OLX_CHUNK_IRRADIANCE];
  field->moments = data[OLX_CHUNK_MOMENTS];
  field->distance_scale = info->distance_scale_metres;
  return OLX_OK;
}

static olx_result check_flags(const olx_field *field, const uint8_t *flags, uint32_t count, uint32_t buried,
                              const char *kind) {
  uint32_t found = 0;
  for (uint32_t i = 0; i < count; i++) found += flags[i] & OLX_PROBE_BURIED;
  if (found == buried) return OLX_OK;
  return olx_fail(OLX_ERROR_FORMAT, "%s: %u %s probes are flagged as buried where the description says %u", field->name,
                  found, kind, buried);
}

static olx_result check_structure(olx_field *field) {
  OLX_TRY(check_header(field));
  OLX_TRY(check_table(field));
  OLX_TRY(read_info(field));
  OLX_TRY(find_chunks(field));
  const olx_field_info *info = &field->info;
  OLX_TRY(olx_positions_check(field->probe_positions, info->probe_count, info->has_grid ? &info->grid : NULL,
                              "light field", field->name, OLX_ERROR_FORMAT));
  OLX_TRY(olx_positions_check(field->irradiance_positions, info->irradiance_probe_count, &info->irradiance_grid,
                              "irradiance", field->name, OLX_ERROR_FORMAT));
  OLX_TRY(check_flags(field, field->probe_flags, info->probe_count, info->buried_count, "light field"));
  return check_flags(field, field->irradiance_flags, info->irradiance_probe_count, info->irradiance_buried_count,
                     "irradiance");
}

// Takes over the mapping, also when it fails.
static olx_result open_data(const char *name, olx_mapped_file file, bool mapped, olx_field **opened) {
  olx_field *field = olx_allocate_zero(1, sizeof *field);
  char *copy = olx_copy_string(name);
  if (!field || !copy) {
    olx_release(copy);
    olx_release(field);
    if (mapped) olx_unmap_file(&file);
    return olx_fail(OLX_ERROR_MEMORY, "%s: out of memory", name);
  }
  field->data = file.data;
  field->size_bytes = file.size_bytes;
  field->mapped = mapped;
  field->name = copy;
  const olx_result result = check_structure(field);
  if (result != OLX_OK) {
    olx_field_close(field);
    return result;
  }
  *opened = field;
  return OLX_OK;
}

olx_result olx_field_open(const char *path, olx_field **field) {
  assert(path && field);
  *field = NULL;
  olx_mapped_file file = {0};
  OLX_TRY(olx_map_file(path, &file));
  return open_data(path, file, true, field);
}

olx_result olx_field_open_memory(const void *data, size_t size_bytes, olx_field **field) {
  assert(field && (data || size_bytes == 0));
  *field = NULL;
  if ((uintptr_t)data % OLX_FIELD_ALIGNMENT != 0) {
    return olx_fail(OLX_ERROR_ARGUMENT, "field in memory: not aligned to %d bytes", OLX_FIELD_ALIGNMENT);
  }
  return open_data("field in memory", (olx_mapped_file){.data = data, .size_bytes = size_bytes}, false, field);
}

void olx_field_close(olx_field *field) {
  if (!field) return;
  if (field->mapped) olx_unmap_file(&(olx_mapped_file){.data = field->data, .size_bytes = field->size_bytes});
  olx_release(field->name);
  olx_release(field);
}

olx_field_info olx_field_describe(const olx_field *field) {
  assert(field);
  return field->info;
}

olx_vec3 olx_field_probe_position(const olx_field *field, uint32_t index) {
  assert(field && index < field->info.probe_count);
  return field->probe_positions[index];
}

bool olx_field_probe_buried(const olx_field *field, uint32_t index) {
  assert(field && index < field->info.probe_count);
  return (field->probe_flags[index] & OLX_PROBE_BURIED) != 0;
}
