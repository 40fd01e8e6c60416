// Opens a field by mapping its file and checking its structure, and describes it: its sizes, its selectors, and the
// positions and flags of its probes.
#include "core/file.h"
#include "core/hooks.h"
#include "core/result.h"
#include "field/field_file.h"
#include "field/selector_data.h"

#include <assert.h>
#include <string.h>

// Finds the structures of the selectors that the description names, and of no others.
static olx_result find_selectors(olx_field *field, const olx_chunk_shape shapes[OLX_CHUNK_KINDS]) {
  const olx_chunk_file file = olx_field_file(field);
  for (olx_select select = OLX_SELECT_VORONOI; select < OLX_SELECT_STORED; select++) {
    const uint32_t type = shapes[olx_select_chunk(select)].type;
    const bool named = (field->info.select_mask & 1u << select) != 0;
    const olx_file_chunk *chunk;
    OLX_TRY(olx_chunk_find_optional(&file, type, &chunk));
    if (named != (chunk != NULL)) {
      return olx_fail(OLX_ERROR_FORMAT, "%s: %s chunk %s, but the description %s", field->name, chunk ? "a" : "no",
                      olx_chunk_type_name(type).text, named ? "names its selector" : "does not name its selector");
    }
    if (!chunk) continue;
    field->select_data[select] = (const char *)field->data + chunk->offset;
    field->select_bytes[select] = chunk->size_bytes;
    field->info.bytes.selectors += chunk->size_bytes;
    field->info.bytes.select[select] = chunk->size_bytes;
  }
  return OLX_OK;
}

static olx_result check_selectors(olx_field *field) {
  if (field->select_data[OLX_SELECT_VORONOI]) OLX_TRY(olx_voronoi_check(field));
  if (field->select_data[OLX_SELECT_OCTREE]) OLX_TRY(olx_octree_check(field));
  const void *bricks = field->select_data[OLX_SELECT_BRICKS];
  if (!bricks) return OLX_OK;
  const size_t size_bytes = field->select_bytes[OLX_SELECT_BRICKS];
  OLX_TRY(olx_bricks_open(bricks, size_bytes, field->info.probes.count, field->name, &field->bricks));
  return OLX_OK;
}

static olx_result refuse_unknown(const olx_chunk_file *file, const olx_field_info *info,
                                 const olx_chunk_shape shapes[OLX_CHUNK_KINDS]) {
  olx_chunk_shape required[OLX_CHUNK_KINDS];
  uint32_t count = 0;
  for (uint32_t k = 0; k < OLX_CHUNK_KINDS; k++) {
    if (olx_chunk_is_required(info, k)) required[count++] = shapes[k];
  }
  return olx_chunk_refuse_unknown(file, required, count);
}

// Refuses probe light in a field whose description has no irradiance probes, and normals in one with geometry blocks.
static olx_result refuse_undescribed(const olx_chunk_file *file, olx_chunk_kind kind, uint32_t type) {
  const olx_file_chunk *chunk;
  OLX_TRY(olx_chunk_find_any(file, type, &chunk));
  if (!chunk) return OLX_OK;
  return olx_fail(OLX_ERROR_FORMAT, "%s: a chunk %s, but the description has %s", file->name,
                  olx_chunk_type_name(type).text,
                  kind == OLX_CHUNK_NORMAL ? "geometry in blocks" : "no irradiance probes");
}

// Finds the chunks whose sizes follow from the description; NULL for those that it does not call for.
static olx_result find_described(const olx_chunk_file *file, const olx_field_info *info,
                                 const olx_chunk_shape shapes[OLX_CHUNK_KINDS], const void *data[OLX_CHUNK_KINDS]) {
  for (uint32_t k = 0; k < OLX_CHUNK_LIGHTS; k++) {
    data[k] = NULL;
    OLX_TRY(olx_chunk_is_required(info, k) ? olx_chunk_find_shaped(file, &shapes[k], &data[k])
                                           : refuse_undescribed(file, k, shapes[k].type));
  }
  return OLX_OK;
}

static olx_result find_chunks(olx_field *field) {
  olx_chunk_shape shapes[OLX_CHUNK_KINDS];
  const void *data[OLX_CHUNK_KINDS];
  const olx_chunk_file file = olx_field_file(field);
  olx_chunk_shapes(&field->info, shapes);
  OLX_TRY(find_described(&file, &field->info, shapes, data));
  OLX_TRY(olx_chunk_find_origin(&file, field->origin));
  OLX_TRY(refuse_unknown(&file, &field->info, shapes));
  OLX_TRY(find_selectors(field, shapes));
  olx_field_info *info = &field->info;
  info->bytes.file = field->size_bytes;
  info->bytes.radiance = shapes[OLX_CHUNK_RADIANCE].size_bytes;
  info->bytes.normal = info->maps.geometry_blocks ? 0 : shapes[OLX_CHUNK_NORMAL].size_bytes;
  if (info->maps.geometry_blocks) info->bytes.geometry = shapes[OLX_CHUNK_DISTANCE].size_bytes;
  else info->bytes.distance = shapes[OLX_CHUNK_DISTANCE].size_bytes;
  info->bytes.pyramid = shapes[OLX_CHUNK_LEAST].size_bytes + shapes[OLX_CHUNK_GREATEST].size_bytes;
  info->bytes.irradiance = shapes[OLX_CHUNK_IRRADIANCE].size_bytes;
  info->bytes.moments = shapes[OLX_CHUNK_MOMENTS].size_bytes;
  field->probe_positions = data[OLX_CHUNK_PROBE_POSITIONS];
  field->probe_flags = data[OLX_CHUNK_PROBE_FLAGS];
  field->irradiance_positions = data[OLX_CHUNK_IRRADIANCE_POSITIONS];
  field->irradiance_flags = data[OLX_CHUNK_IRRADIANCE_FLAGS];
  field->n = info->maps.size;
  field->stride = field->n + 2;
  field->texels = (size_t)field->stride * field->stride;
  field->radiance = data[OLX_CHUNK_RADIANCE];
  field->normal = data[OLX_CHUNK_NORMAL];
  if (info->maps.geometry_blocks) field->geometry = data[OLX_CHUNK_DISTANCE];
  else field->distance = data[OLX_CHUNK_DISTANCE];
  field->pyramid = olx_pyramid_shape_of(field->n, info->maps.geometry_blocks);
  field->least = data[OLX_CHUNK_LEAST];
  field->greatest = data[OLX_CHUNK_GREATEST];
  field->irradiance_n = info->irradiance.size;
  field->irradiance_stride = field->irradiance_n + 2;
  field->irradiance_texels = (size_t)field->irradiance_stride * field->irradiance_stride;
  field->bands = olx_irradiance_bands(info->irradiance.form);
  field->harmonic_halves = olx_harmonics_halves(field->bands);
  if (field->bands) field->harmonics = data[OLX_CHUNK_IRRADIANCE];
  else field->irradiance = data[OLX_CHUNK_IRRADIANCE];
  field->moments = data[OLX_CHUNK_MOMENTS];
  field->surfaces = info->maps.compressed ? (olx_field_surfaces){.base_blocks = data[OLX_CHUNK_BASE],
                                                                 .specular_blocks = data[OLX_CHUNK_SPECULAR],
                                                                 .direct_blocks = data[OLX_CHUNK_DIRECT],
                                                                 .indirect_blocks = data[OLX_CHUNK_INDIRECT]}
                                          : (olx_field_surfaces){.base = data[OLX_CHUNK_BASE],
                                                                 .specular = data[OLX_CHUNK_SPECULAR],
                                                                 .direct = data[OLX_CHUNK_DIRECT],
                                                                 .indirect = data[OLX_CHUNK_INDIRECT]};
  field->surfaces.emission = data[OLX_CHUNK_EMISSION];
  field->surfaces.tile_side = field->n / OLX_EMISSION_TILE;
  info->bytes.material = shapes[OLX_CHUNK_BASE].size_bytes + shapes[OLX_CHUNK_SPECULAR].size_bytes;
  info->bytes.direct = shapes[OLX_CHUNK_DIRECT].size_bytes;
  info->bytes.indirect = shapes[OLX_CHUNK_INDIRECT].size_bytes;
  info->bytes.emission = shapes[OLX_CHUNK_EMISSION].size_bytes;
  field->distance_scale = info->maps.distance_scale_metres;
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

static olx_result refuse_packed(const olx_field *field) {
  const size_t magic_bytes = sizeof OLX_PACKED_MAGIC - 1;
  if (field->size_bytes < magic_bytes || memcmp(field->data, OLX_PACKED_MAGIC, magic_bytes) != 0) return OLX_OK;
  return olx_fail(OLX_ERROR_UNSUPPORTED, "%s: a packed field; `octalux unpack` makes a field of it again", field->name);
}

static olx_result check_structure(olx_field *field) {
  const olx_chunk_file file = olx_field_file(field);
  OLX_TRY(refuse_packed(field));
  OLX_TRY(olx_chunk_file_check(&file, &OLX_FIELD_KIND));
  OLX_TRY(olx_field_info_read(&file, &field->info));
  OLX_TRY(find_chunks(field));
  const olx_field_info *info = &field->info;
  OLX_TRY(olx_positions_check(field->probe_positions, info->probes.count,
                              info->probes.has_grid ? &info->probes.grid : NULL, "light field", field->name,
                              OLX_ERROR_FORMAT));
  OLX_TRY(olx_positions_check(field->irradiance_positions, info->irradiance.probe_count, &info->irradiance.grid,
                              "irradiance", field->name, OLX_ERROR_FORMAT));
  OLX_TRY(check_selectors(field));
  OLX_TRY(olx_surfaces_open(field));
  OLX_TRY(olx_classic_open(field));
  OLX_TRY(olx_field_volume_open(field));
  OLX_TRY(olx_relight_open(field));
  OLX_TRY(check_flags(field, field->probe_flags, info->probes.count, info->probes.buried, "light field"));
  return check_flags(field, field->irradiance_flags, info->irradiance.probe_count, info->irradiance.buried,
                     "irradiance");
}

// Opens a field from a mapped file and takes ownership of the mapping, even when it fails.
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
  if ((uintptr_t)data % OLX_CHUNK_ALIGNMENT != 0) {
    return olx_fail(OLX_ERROR_ARGUMENT, "field in memory: not aligned to %d bytes", OLX_CHUNK_ALIGNMENT);
  }
  return open_data("field in memory", (olx_mapped_file){.data = data, .size_bytes = size_bytes}, false, field);
}

// Reads the description, whose layout has not changed since version 1.
static olx_result describe_version_1(const olx_chunk_file *file, olx_field_info *info) {
  olx_file_kind kind = OLX_FIELD_KIND;
  kind.version = 1;
  kind.remedy = "";
  OLX_TRY(olx_chunk_file_check(file, &kind));
  OLX_TRY(olx_field_info_read(file, info));
  info->bytes.file = file->size_bytes;
  return OLX_OK;
}

olx_result olx_field_describe_version_1(const char *path, olx_field_info *info) {
  assert(path && info);
  olx_mapped_file mapped = {0};
  OLX_TRY(olx_map_file(path, &mapped));
  const olx_chunk_file file = {.data = mapped.data, .size_bytes = mapped.size_bytes, .name = path};
  const olx_result result = describe_version_1(&file, info);
  olx_unmap_file(&mapped);
  return result;
}

void olx_field_close(olx_field *field) {
  if (!field) return;
  if (field->mapped) olx_unmap_file(&(olx_mapped_file){.data = field->data, .size_bytes = field->size_bytes});
  olx_release(field->name);
  olx_release(field);
}

const char *olx_select_name(olx_select select) {
  static const char *const names[] = {"cage", "voronoi", "octree", "bricks", "exhaustive", "best"};
  return (size_t)select < sizeof names / sizeof *names ? names[select] : "unknown";
}

const char *olx_irradiance_form_name(olx_irradiance_form form) {
  static const char *const names[] = {"octahedral", "sh2", "sh3"};
  return (size_t)form < sizeof names / sizeof *names ? names[form] : "unknown";
}

olx_field_info olx_field_describe(const olx_field *field) {
  assert(field);
  return field->info;
}

void olx_field_origin(const olx_field *field, double origin[3]) {
  assert(field);
  for (int axis = 0; axis < 3; axis++) origin[axis] = field->origin[axis];
}

olx_vec3 olx_field_probe_position(const olx_field *field, uint32_t index) {
  assert(field);
  return index < field->info.probes.count ? field->probe_positions[index] : olx_splat(NAN);
}

bool olx_field_probe_buried(const olx_field *field, uint32_t index) {
  assert(field);
  return index >= field->info.probes.count || (field->probe_flags[index] & OLX_PROBE_BURIED) != 0;
}

bool olx_field_irradiance_probe_buried(const olx_field *field, uint32_t index) {
  assert(field);
  return index >= field->info.irradiance.probe_count || (field->irradiance_flags[index] & OLX_PROBE_BURIED) != 0;
}
