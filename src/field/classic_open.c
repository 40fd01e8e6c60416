// Checks the chunks that hold classic maps, irradiance probes without visibility, and reads from them the description
// of the maps and each probe's box for reflections.
#include "core/result.h"
#include "field/field_chunks.h"

static olx_result check_header(const olx_field *field, const olx_classic_header *header) {
  uint32_t reserved = 0;
  for (uint32_t i = 0; i < sizeof header->zero / sizeof header->zero[0]; i++) reserved |= header->zero[i];
  if (header->levels == OLX_CLASSIC_LEVELS && header->table_side == OLX_CLASSIC_TABLE_SIDE && !reserved) return OLX_OK;
  return olx_fail(OLX_ERROR_FORMAT, "%s: chunk CLAS: %u levels, a table of %u entries a side, or reserved bytes",
                  field->name, header->levels, header->table_side);
}

// Copies what the header says into the field's description.
static olx_result read_header(olx_field *field, const olx_chunk_file *file, const olx_chunk_shape *shape) {
  const void *data;
  OLX_TRY(olx_chunk_find_header(file, shape, &data));
  if (!data) return OLX_OK;
  const olx_classic_header *header = data;
  OLX_TRY(check_header(field, header));
  field->info.classic.size = header->size;
  field->info.classic.cube_size = header->cube_size;
  field->info.classic.sharpness = header->sharpness;
  OLX_TRY(olx_classic_info_check(&field->info, field->name, OLX_ERROR_FORMAT));
  field->classic.size = header->size;
  field->classic.table = header->table;
  return OLX_OK;
}

// Returns whether `middle` lies within a finite range; false for NaN too.
static bool is_around(float low, float middle, float high) {
  return low >= -OLX_FIELD_MAX_LENGTH && low <= middle && middle <= high && high <= OLX_FIELD_MAX_LENGTH;
}

// Checks that boxes are finite and contain their probes, because the runtime relies on it.
static olx_result check_boxes(const olx_field *field) {
  for (uint32_t i = 0; i < field->info.irradiance.probe_count; i++) {
    const olx_vec3 low = field->classic.boxes[i].low, p = field->irradiance_positions[i],
                   high = field->classic.boxes[i].high;
    if (is_around(low.x, p.x, high.x) && is_around(low.y, p.y, high.y) && is_around(low.z, p.z, high.z)) continue;
    return olx_fail(OLX_ERROR_FORMAT, "%s: chunk CBOX: box (%g %g %g) to (%g %g %g) is not around probe %u",
                    field->name, (double)low.x, (double)low.y, (double)low.z, (double)high.x, (double)high.y,
                    (double)high.z, i);
  }
  return OLX_OK;
}

olx_result olx_classic_open(olx_field *field) {
  const olx_chunk_file file = olx_field_file(field);
  olx_chunk_shape shapes[OLX_CHUNK_KINDS];
  const void *data[OLX_CHUNK_KINDS] = {NULL};
  olx_chunk_shapes(&field->info, shapes);
  OLX_TRY(read_header(field, &file, &shapes[OLX_CHUNK_CLASSIC]));
  olx_chunk_shapes(&field->info, shapes);
  // A file holds all chunks of classic maps or none.
  for (uint32_t k = OLX_CHUNK_CLASSIC_IRRADIANCE; k <= OLX_CHUNK_CLASSIC_BOXES; k++) {
    OLX_TRY(
        olx_chunk_find_wanted(&file, &shapes[k], shapes[OLX_CHUNK_CLASSIC].type, field->classic.size > 0, &data[k]));
  }
  if (field->classic.size == 0) return OLX_OK;
  olx_classic_maps *maps = &field->classic;
  maps->irradiance = data[OLX_CHUNK_CLASSIC_IRRADIANCE];
  maps->radiance = data[OLX_CHUNK_CLASSIC_RADIANCE];
  maps->boxes = data[OLX_CHUNK_CLASSIC_BOXES];
  maps->irradiance_texels = (size_t)(maps->size + 2) * (maps->size + 2);
  maps->radiance_texels = olx_classic_first(maps->size, OLX_CLASSIC_LEVELS);
  for (uint32_t level = 0; level < OLX_CLASSIC_LEVELS; level++) {
    maps->level_first[level] = olx_classic_first(maps->size, level);
  }
  for (uint32_t k = OLX_CHUNK_CLASSIC; k <= OLX_CHUNK_CLASSIC_BOXES; k++) {
    field->info.bytes.classic += shapes[k].size_bytes;
  }
  return check_boxes(field);
}
