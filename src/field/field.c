// Opens a field by mapping its file and checking its structure, and describes it: its sizes, its selectors, and the
// positions and flags of its probes.
#include "core/file.h"
#include "core/hooks.h"
#include "core/result.h"
#include "field/field_chunks.h"

#include <assert.h>
#include <string.h>

static olx_result refuse_unknown(const olx_chunk_file *file, const olx_field_info *info,
                                 const olx_chunk_shape shapes[OLX_CHUNK_KINDS]) {
  olx_chunk_shape required[OLX_CHUNK_KINDS];
  uint32_t count = 0;
  for (uint32_t k = 0; k < OLX_CHUNK_KINDS; k++) {
    if (olx_chunk_is_required(info, k)) required[count++] = shapes[k];
  }
  return olx_chunk_refuse_unknown(file, required, count);
}

static olx_result refuse_type(const olx_chunk_file *file, const olx_chunk_need *need, uint32_t type) {
  const olx_file_chunk *chunk;
  OLX_TRY(olx_chunk_find_any(file, type, &chunk));
  if (!chunk) return OLX_OK;
  return olx_fail(OLX_ERROR_FORMAT, "%s: a chunk %s, but the description has %s", file->name,
                  olx_chunk_type_name(type).text, need->otherwise);
}

// Refuses a chunk that the description does not call for, in whichever form.
static olx_result refuse_undescribed(const olx_chunk_file *file, const olx_chunk_traits *kind) {
  OLX_TRY(refuse_type(file, kind->need, kind->form.type));
  return kind->is_other ? refuse_type(file, kind->need, kind->other.type) : OLX_OK;
}

// Refuses a chunk in the form that this field does not use.
static olx_result refuse_other_form(const olx_chunk_file *file, const olx_field_info *info, olx_chunk_kind k) {
  const olx_chunk_traits *kind = &olx_chunk_kinds[k];
  const olx_chunk_form *used = olx_chunk_form_of(info, k);
  if (!kind->is_other || !kind->need->holds(info)) return OLX_OK;
  const uint32_t other = used == &kind->form ? kind->other.type : kind->form.type;
  const olx_file_chunk *chunk;
  OLX_TRY(olx_chunk_find_any(file, other, &chunk));
  if (!chunk) return OLX_OK;
  return olx_fail(OLX_ERROR_FORMAT, "%s: a chunk %s, but the description has %s", file->name,
                  olx_chunk_type_name(other).text, olx_chunk_type_name(used->type).text);
}

// Finds a chunk whose size follows from the description, and sets the field's pointer to it.
static olx_result find_described(olx_field *field, const olx_chunk_file *file, const olx_chunk_form *form,
                                 const olx_chunk_shape *shape) {
  const void *data;
  OLX_TRY(olx_chunk_find_shaped(file, shape, &data));
  if (form->data) memcpy((char *)field + form->data, &data, sizeof data);
  if (form->bytes) *(uint64_t *)((char *)&field->info.bytes + form->bytes) += shape->size_bytes;
  return OLX_OK;
}

static bool is_described(olx_chunk_kind k) { return olx_chunk_kinds[k].need && olx_chunk_kinds[k].records_of; }

static olx_result find_chunks(olx_field *field, const olx_chunk_file *file) {
  const olx_field_info *info = &field->info;
  olx_chunk_shape shapes[OLX_CHUNK_KINDS];
  olx_chunk_shapes(info, shapes);
  for (uint32_t k = 0; k < OLX_CHUNK_KINDS; k++) {
    const olx_chunk_traits *kind = &olx_chunk_kinds[k];
    if (!is_described(k)) continue;
    OLX_TRY(kind->need->holds(info) ? find_described(field, file, olx_chunk_form_of(info, k), &shapes[k])
                                    : refuse_undescribed(file, kind));
  }
  for (uint32_t k = 0; k < OLX_CHUNK_KINDS; k++) {
    if (is_described(k)) OLX_TRY(refuse_other_form(file, info, k));
  }
  return refuse_unknown(file, info, shapes);
}

// Sets the sizes that follow from the description.
static void measure(olx_field *field) {
  const olx_field_info *info = &field->info;
  field->n = info->maps.size;
  field->stride = field->n + 2;
  field->texels = (size_t)field->stride * field->stride;
  field->pyramid = olx_pyramid_shape_of(field->n, info->maps.geometry_blocks);
  field->irradiance_n = info->irradiance.size;
  field->irradiance_stride = field->irradiance_n + 2;
  field->irradiance_texels = (size_t)field->irradiance_stride * field->irradiance_stride;
  field->bands = olx_irradiance_bands(info->irradiance.form);
  field->harmonic_halves = olx_harmonics_halves(field->bands);
  field->surfaces.tile_side = field->n / OLX_EMISSION_TILE;
  field->distance_scale = info->maps.distance_scale_metres;
}

olx_result olx_origin_open(olx_field *field) {
  const olx_chunk_file file = olx_field_file(field);
  return olx_chunk_find_origin(&file, field->origin);
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
  field->info.bytes.file = field->size_bytes;
  measure(field);
  OLX_TRY(find_chunks(field, &file));
  for (uint32_t k = 0; k < OLX_CHUNK_KINDS; k++) {
    if (olx_chunk_kinds[k].open) OLX_TRY(olx_chunk_kinds[k].open(field));
  }
  return OLX_OK;
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
