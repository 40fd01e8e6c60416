#include "core/result.h"
#include "field/field_file.h"

olx_result olx_relight_info_check(const olx_field_info *info, const char *name, olx_result failure) {
  const uint32_t size = info->relight_size, points = info->relight_points, rays = info->relight_rays,
                 hidden = info->relight_hidden;
  if (size != 16 && size != 32 && size != 64 && size != 128) {
    return olx_fail(failure, "%s: %u surfaces along a side are not 16, 32, 64 or 128", name, size);
  }
  if (!info->irradiance_probe_count) return olx_fail(failure, "%s: relighting, but no irradiance probes", name);
  if (info->irradiance_form != OLX_IRRADIANCE_OCTAHEDRAL) {
    return olx_fail(failure, "%s: relighting needs octahedral irradiance, not %s", name,
                    olx_irradiance_form_name(info->irradiance_form));
  }
  if (((uint64_t)size * size + hidden) * info->irradiance_probe_count > OLX_SURFACE_MOST) {
    return olx_fail(failure, "%s: too many irradiance probes for maps of surfaces", name);
  }
  if (points > OLX_FIT_MOST_POINTS || rays > OLX_FIT_MOST_RAYS || (points == 0) != (rays == 0)) {
    return olx_fail(failure, "%s: %u points of %u rays a probe: at most %d of %d, or none", name, points, rays,
                    OLX_FIT_MOST_POINTS, OLX_FIT_MOST_RAYS);
  }
  if (hidden > OLX_HIDDEN_MOST || (hidden > 0 && points == 0)) {
    return olx_fail(failure, "%s: %u hidden surfaces and %u points a probe: at most %d, none without points", name,
                    hidden, points, OLX_HIDDEN_MOST);
  }
  return OLX_OK;
}

// What the header says becomes part of the field's description.
static olx_result read_header(olx_field *field, const olx_chunk_file *file, const olx_chunk_shape *shape) {
  const void *data;
  OLX_TRY(olx_chunk_find_header(file, shape, &data));
  if (!data) return OLX_OK;
  const olx_relight_header *header = data;
  for (uint32_t i = 0; i < sizeof header->zero / sizeof header->zero[0]; i++) {
    if (header->zero[i]) return olx_fail(OLX_ERROR_FORMAT, "%s: chunk RLIT: reserved bytes", field->name);
  }
  field->info.relight_size = header->size;
  field->info.relight_points = header->points;
  field->info.relight_rays = header->rays;
  field->info.relight_hidden = header->hidden;
  return olx_relight_info_check(&field->info, field->name, OLX_ERROR_FORMAT);
}

bool olx_relight_has_chunk(const olx_field_info *info, olx_chunk_kind kind) {
  if (kind == OLX_CHUNK_FIT) return info->relight_points > 0;
  return kind == OLX_CHUNK_HIDDEN ? info->relight_hidden > 0 : info->relight_size > 0;
}

olx_result olx_relight_open(olx_field *field) {
  const olx_chunk_file file = olx_field_file(field);
  olx_chunk_shape shapes[OLX_CHUNK_KINDS];
  const void *data[OLX_CHUNK_KINDS] = {NULL};
  olx_chunk_shapes(&field->info, shapes);
  OLX_TRY(read_header(field, &file, &shapes[OLX_CHUNK_RELIGHT]));
  olx_chunk_shapes(&field->info, shapes);
  for (uint32_t k = OLX_CHUNK_ALBEDO; k <= OLX_CHUNK_HIDDEN; k++) {
    OLX_TRY(olx_chunk_find_wanted(&file, &shapes[k], shapes[OLX_CHUNK_RELIGHT].type,
                                  olx_relight_has_chunk(&field->info, k), &data[k]));
  }
  if (!field->info.relight_size) return OLX_OK;
  field->relight = (olx_relight_maps){.size = field->info.relight_size,
                                      .points = field->info.relight_points,
                                      .rays = field->info.relight_rays,
                                      .hidden = field->info.relight_hidden,
                                      .albedo = data[OLX_CHUNK_ALBEDO],
                                      .surfaces = data[OLX_CHUNK_SURFACES],
                                      .fit = data[OLX_CHUNK_FIT],
                                      .hidden_surfaces = data[OLX_CHUNK_HIDDEN]};
  for (uint32_t k = OLX_CHUNK_RELIGHT; k <= OLX_CHUNK_HIDDEN; k++) {
    if (olx_relight_has_chunk(&field->info, k)) field->info.relight_bytes += shapes[k].size_bytes;
  }
  return OLX_OK;
}
