#include "core/result.h"
#include "field/field_file.h"

olx_result olx_relight_info_check(const olx_field_info *info, const char *name, olx_result failure) {
  const uint32_t size = info->relight_size, points = info->relight_points, rays = info->relight_rays;
  if (size != 16 && size != 32 && size != 64 && size != 128) {
    return olx_fail(failure, "%s: %u surfaces along a side are not 16, 32, 64 or 128", name, size);
  }
  if (info->irradiance_form != OLX_IRRADIANCE_OCTAHEDRAL) {
    return olx_fail(failure, "%s: relighting needs octahedral irradiance, not %s", name,
                    olx_irradiance_form_name(info->irradiance_form));
  }
  if ((uint64_t)size * size * info->irradiance_probe_count > OLX_SURFACE_MOST) {
    return olx_fail(failure, "%s: too many irradiance probes for maps of surfaces", name);
  }
  if (points > OLX_FIT_MOST_POINTS || rays > OLX_FIT_MOST_RAYS || (points == 0) != (rays == 0)) {
    return olx_fail(failure, "%s: %u points of %u rays a probe: at most %d of %d, or none", name, points, rays,
                    OLX_FIT_MOST_POINTS, OLX_FIT_MOST_RAYS);
  }
  return OLX_OK;
}

// What the header says becomes part of the field's description.
static olx_result read_header(olx_field *field, const olx_chunk_file *file, const olx_chunk_shape *shape) {
  const olx_file_chunk *chunk;
  const void *data;
  OLX_TRY(olx_chunk_find_optional(file, shape->type, &chunk));
  if (!chunk) return OLX_OK;
  OLX_TRY(olx_chunk_find_optional_shaped(file, shape, &data));
  const olx_relight_header *header = data;
  if (olx_content_hash(header, sizeof *header) != chunk->hash) {
    return olx_fail(OLX_ERROR_CHECKSUM, "%s: chunk RLIT: wrong checksum", field->name);
  }
  for (uint32_t i = 0; i < sizeof header->zero / sizeof header->zero[0]; i++) {
    if (header->zero[i]) return olx_fail(OLX_ERROR_FORMAT, "%s: chunk RLIT: reserved bytes", field->name);
  }
  field->info.relight_size = header->size;
  field->info.relight_points = header->points;
  field->info.relight_rays = header->rays;
  return olx_relight_info_check(&field->info, field->name, OLX_ERROR_FORMAT);
}

static bool is_wanted(const olx_field_info *info, uint32_t kind) {
  return kind == OLX_CHUNK_FIT ? info->relight_points > 0 : info->relight_size > 0;
}

static olx_result find_maps(const olx_field *field, const olx_chunk_file *file, const olx_chunk_shape *shapes,
                            const void *data[OLX_CHUNK_KINDS]) {
  for (uint32_t k = OLX_CHUNK_ALBEDO; k <= OLX_CHUNK_FIT; k++) {
    const olx_file_chunk *chunk;
    const bool wanted = is_wanted(&field->info, k);
    OLX_TRY(olx_chunk_find_optional(file, shapes[k].type, &chunk));
    if ((chunk != NULL) != wanted) {
      return olx_fail(OLX_ERROR_FORMAT, "%s: %s chunk %s, but %s", field->name, chunk ? "a" : "no",
                      olx_chunk_type_name(shapes[k].type).text,
                      wanted ? "chunk RLIT speaks of it" : "no chunk RLIT that speaks of it");
    }
    if (chunk) OLX_TRY(olx_chunk_find_optional_shaped(file, &shapes[k], &data[k]));
  }
  return OLX_OK;
}

olx_result olx_relight_open(olx_field *field) {
  const olx_chunk_file file = olx_field_file(field);
  olx_chunk_shape shapes[OLX_CHUNK_KINDS];
  const void *data[OLX_CHUNK_KINDS] = {NULL};
  olx_chunk_shapes(&field->info, shapes);
  OLX_TRY(read_header(field, &file, &shapes[OLX_CHUNK_RELIGHT]));
  olx_chunk_shapes(&field->info, shapes);
  OLX_TRY(find_maps(field, &file, shapes, data));
  if (!field->info.relight_size) return OLX_OK;
  field->relight = (olx_relight_maps){.size = field->info.relight_size,
                                      .points = field->info.relight_points,
                                      .rays = field->info.relight_rays,
                                      .albedo = data[OLX_CHUNK_ALBEDO],
                                      .surfaces = data[OLX_CHUNK_SURFACES],
                                      .fit = data[OLX_CHUNK_FIT]};
  for (uint32_t k = OLX_CHUNK_RELIGHT; k <= OLX_CHUNK_FIT; k++) {
    if (is_wanted(&field->info, k)) field->info.relight_bytes += shapes[k].size_bytes;
  }
  return OLX_OK;
}
