// Stores and loads the description of a field file, and checks it and the positions of probes.
#include "field/field_file.h"

#include "core/result.h"

#include <octalux/limits.h>

static olx_file_grid store_grid(const olx_grid *grid) {
  olx_file_grid stored = {.count = {grid->count[0], grid->count[1], grid->count[2]}};
  olx_store3(stored.origin, grid->origin);
  olx_store3(stored.spacing, grid->spacing);
  return stored;
}

static olx_grid load_grid(const olx_file_grid *stored) {
  return (olx_grid){.origin = olx_load3(stored->origin),
                    .spacing = olx_load3(stored->spacing),
                    .count = {stored->count[0], stored->count[1], stored->count[2]}};
}

olx_file_info olx_field_info_store(const olx_field_info *info) {
  olx_file_info stored = {.probe_count = info->probes.count,
                          .irradiance_probe_count = info->irradiance.probe_count,
                          .buried_count = info->probes.buried,
                          .irradiance_buried_count = info->irradiance.buried,
                          .has_grid = info->probes.has_grid,
                          .radiance_size = info->maps.size,
                          .irradiance_size = info->irradiance.size,
                          .irradiance_form = info->irradiance.form,
                          .select_mask = info->select_mask,
                          .bounces = info->bounces.count,
                          .samples = info->maps.samples,
                          .distance_scale = info->maps.distance_scale_metres,
                          .irradiance_grid = store_grid(&info->irradiance.grid),
                          .scene_hash = info->scene.hash,
                          .last_bounce = info->bounces.last,
                          .form = (info->maps.compressed ? OLX_FORM_TILES : 0u) |
                                  (info->maps.geometry_blocks ? OLX_FORM_GEOMETRY : 0u)};
  if (info->probes.has_grid) stored.grid = store_grid(&info->probes.grid);
  olx_store3(stored.scene_min, info->scene.bounds_min);
  olx_store3(stored.scene_max, info->scene.bounds_max);
  return stored;
}

olx_field_info olx_field_info_load(const olx_file_info *stored) {
  return (olx_field_info){.probes = {.count = stored->probe_count,
                                     .buried = stored->buried_count,
                                     .has_grid = stored->has_grid != 0,
                                     .grid = load_grid(&stored->grid)},
                          .maps = {.size = stored->radiance_size,
                                   .samples = stored->samples,
                                   .distance_scale_metres = stored->distance_scale,
                                   .compressed = (stored->form & OLX_FORM_TILES) != 0,
                                   .geometry_blocks = (stored->form & OLX_FORM_GEOMETRY) != 0},
                          .irradiance = {.probe_count = stored->irradiance_probe_count,
                                         .buried = stored->irradiance_buried_count,
                                         .grid = load_grid(&stored->irradiance_grid),
                                         .size = stored->irradiance_size,
                                         .form = (olx_irradiance_form)stored->irradiance_form},
                          .select_mask = stored->select_mask,
                          .bounces = {.count = stored->bounces, .last = stored->last_bounce},
                          .scene = {.bounds_min = olx_load3(stored->scene_min),
                                    .bounds_max = olx_load3(stored->scene_max),
                                    .hash = stored->scene_hash}};
}

static bool is_power_of_two_in(uint32_t size, uint32_t low, uint32_t high) {
  return size >= low && size <= high && (size & (size - 1)) == 0;
}

// Returns whether a length is within bounds; false for NaN too.
static bool is_length(float f) { return fabsf(f) <= OLX_FIELD_MAX_LENGTH; }
static bool is_place(olx_vec3 v) { return is_length(v.x) && is_length(v.y) && is_length(v.z); }

olx_result olx_classic_info_check(const olx_field_info *info, const char *name, olx_result failure) {
  if (!info->irradiance.probe_count) return olx_fail(failure, "%s: classic maps, but no irradiance probes", name);
  if (!is_power_of_two_in(info->classic.size, OLX_CLASSIC_SIZE_LEAST, OLX_CLASSIC_SIZE_MOST)) {
    return olx_fail(failure, "%s: classic size %u is not a power of two in %d..%d", name, info->classic.size,
                    OLX_CLASSIC_SIZE_LEAST, OLX_CLASSIC_SIZE_MOST);
  }
  if (!is_power_of_two_in(info->classic.cube_size, OLX_CLASSIC_CUBE_SIZE_LEAST, OLX_CLASSIC_CUBE_SIZE_MOST)) {
    return olx_fail(failure, "%s: cube maps of %u texels: not a power of two in %d..%d", name, info->classic.cube_size,
                    OLX_CLASSIC_CUBE_SIZE_LEAST, OLX_CLASSIC_CUBE_SIZE_MOST);
  }
  if (!(info->classic.sharpness >= (float)OLX_CLASSIC_SHARPNESS_LEAST &&
        info->classic.sharpness <= (float)OLX_CLASSIC_SHARPNESS_MOST)) {
    return olx_fail(failure, "%s: classic sharpness %g is not in %d..%d", name, (double)info->classic.sharpness,
                    OLX_CLASSIC_SHARPNESS_LEAST, OLX_CLASSIC_SHARPNESS_MOST);
  }
  return OLX_OK;
}

static olx_result check_grid(const olx_grid *grid, uint32_t probe_count, const char *kind, const char *name,
                             olx_result failure) {
  const float spacings[3] = {grid->spacing.x, grid->spacing.y, grid->spacing.z};
  uint64_t product = 1;
  for (uint32_t axis = 0; axis < 3; axis++) {
    const uint32_t count = grid->count[axis];
    if (count < 1 || count > OLX_FIELD_MAX_GRID_COUNT) {
      return olx_fail(failure, "%s: %s grid: count %u along %c is not in 1..%d", name, kind, count, "xyz"[axis],
                      OLX_FIELD_MAX_GRID_COUNT);
    }
    product *= count; // below 2^60
    const float spacing = spacings[axis];
    if (count == 1 ? spacing != 0.0f : !(spacing >= OLX_FIELD_MIN_SCALE && is_length(spacing))) {
      return olx_fail(failure, "%s: %s grid: spacing %g along %c does not fit a count of %u", name, kind,
                      (double)spacing, "xyz"[axis], count);
    }
  }
  if (product != probe_count) {
    return olx_fail(failure, "%s: %s grid: %u x %u x %u is not the number of probes, %u", name, kind, grid->count[0],
                    grid->count[1], grid->count[2], probe_count);
  }
  if (!is_place(grid->origin)) return olx_fail(failure, "%s: %s grid: origin out of range", name, kind);
  return OLX_OK;
}

static olx_result check_sizes(const olx_field_info *info, const char *name, olx_result failure) {
  if (!is_power_of_two_in(info->maps.size, OLX_RADIANCE_SIZE_LEAST, OLX_RADIANCE_SIZE_MOST)) {
    return olx_fail(failure, "%s: radiance size %u is not a power of two in %d..%d", name, info->maps.size,
                    OLX_RADIANCE_SIZE_LEAST, OLX_RADIANCE_SIZE_MOST);
  }
  if (info->probes.count < 1) return olx_fail(failure, "%s: no light field probes", name);
  if (info->probes.buried > info->probes.count || info->irradiance.buried > info->irradiance.probe_count) {
    return olx_fail(failure, "%s: more probes are buried than there are", name);
  }
  if (info->maps.samples < 1) return olx_fail(failure, "%s: samples 0 is not at least 1", name);
  return OLX_OK;
}

// Checks that the fields for irradiance probes are 0 in a description without them.
static olx_result check_no_irradiance_probes(const olx_field_info *info, const char *name, olx_result failure) {
  static const olx_grid none = {0};
  const bool silent = info->irradiance.size == 0 && info->irradiance.form == 0 &&
                      memcmp(&info->irradiance.grid, &none, sizeof none) == 0;
  return silent ? OLX_OK : olx_fail(failure, "%s: a size, form or grid of irradiance probes, but none of them", name);
}

static olx_result check_irradiance_probes(const olx_field_info *info, const char *name, olx_result failure) {
  if (!info->irradiance.probe_count) return check_no_irradiance_probes(info, name, failure);
  if (!is_power_of_two_in(info->irradiance.size, OLX_IRRADIANCE_SIZE_LEAST, OLX_IRRADIANCE_SIZE_MOST)) {
    return olx_fail(failure, "%s: irradiance size %u is not a power of two in %d..%d", name, info->irradiance.size,
                    OLX_IRRADIANCE_SIZE_LEAST, OLX_IRRADIANCE_SIZE_MOST);
  }
  if ((uint32_t)info->irradiance.form > OLX_IRRADIANCE_SH3) {
    return olx_fail(failure, "%s: unknown form of irradiance %u", name, (uint32_t)info->irradiance.form);
  }
  return check_grid(&info->irradiance.grid, info->irradiance.probe_count, "irradiance", name, failure);
}

olx_result olx_field_info_check(const olx_field_info *info, const char *name, olx_result failure) {
  OLX_TRY(check_sizes(info, name, failure));
  const float scale = info->maps.distance_scale_metres;
  if (!(scale >= OLX_FIELD_MIN_SCALE && is_length(scale))) {
    return olx_fail(failure, "%s: distance scale %g is not in %g..%g", name, (double)scale, (double)OLX_FIELD_MIN_SCALE,
                    (double)OLX_FIELD_MAX_LENGTH);
  }
  if (!(info->bounces.last >= 0.0f && info->bounces.last <= 1.0f)) {
    return olx_fail(failure, "%s: a share of the last bounce of %g is not in 0..1", name, (double)info->bounces.last);
  }
  const olx_vec3 low = info->scene.bounds_min, high = info->scene.bounds_max;
  if (!is_place(low) || !is_place(high) || low.x > high.x || low.y > high.y || low.z > high.z) {
    return olx_fail(failure, "%s: scene bounds (%g %g %g) to (%g %g %g) are not a box", name, (double)low.x,
                    (double)low.y, (double)low.z, (double)high.x, (double)high.y, (double)high.z);
  }
  if (info->probes.has_grid) OLX_TRY(check_grid(&info->probes.grid, info->probes.count, "light field", name, failure));
  OLX_TRY(check_irradiance_probes(info, name, failure));
  if ((info->select_mask & 1u << OLX_SELECT_CAGE) && !info->probes.has_grid) {
    return olx_fail(failure, "%s: the cage selector needs light field probes on a grid", name);
  }
  return OLX_OK;
}

olx_result olx_field_info_read(const olx_chunk_file *file, olx_field_info *info) {
  const olx_file_chunk *chunk;
  OLX_TRY(olx_chunk_find(file, OLX_FOUR_CC('I', 'N', 'F', 'O'), &chunk));
  if (chunk->size_bytes != sizeof(olx_file_info)) {
    return olx_fail(OLX_ERROR_FORMAT, "%s: chunk INFO: %llu bytes, not %zu", file->name,
                    (unsigned long long)chunk->size_bytes, sizeof(olx_file_info));
  }
  const olx_file_info *stored = (const void *)((const char *)file->data + chunk->offset);
  if (!olx_checksum_holds(olx_content_hash(stored, sizeof *stored), chunk->hash)) {
    return olx_fail(OLX_ERROR_CHECKSUM, "%s: chunk INFO: wrong checksum", file->name);
  }
  if (stored->form & OLX_FORM_BLOCKS) {
    return olx_fail(OLX_ERROR_UNSUPPORTED,
                    "%s: surfaces in maps of blocks, which tiles have replaced; bake the scene again", file->name);
  }
  *info = olx_field_info_load(stored);
  OLX_TRY(olx_field_info_check(info, file->name, OLX_ERROR_FORMAT));
  // Writing the description again must give the same bytes: flags are 0 or 1, and unused values are 0.
  const olx_file_info again = olx_field_info_store(info);
  if (memcmp(&again, stored, sizeof again) == 0) return OLX_OK;
  return olx_fail(OLX_ERROR_FORMAT,
                  "%s: chunk INFO: a flag that is not 0 or 1, an unknown form, or an absent grid that is not 0",
                  file->name);
}

// Returns whether a position lies on the grid, up to the rounding of origin + index * spacing.
static bool stands_on(float position, float expected, float spacing) {
  return fabsf(position - expected) <= 1e-4f * spacing + 1e-6f * fabsf(expected);
}

olx_result olx_positions_check(const olx_vec3 *positions, uint32_t count, const olx_grid *grid, const char *kind,
                               const char *name, olx_result failure) {
  for (uint32_t i = 0; i < count; i++) {
    const olx_vec3 p = positions[i];
    if (!is_place(p)) return olx_fail(failure, "%s: position of %s probe %u is out of range", name, kind, i);
    if (!grid) continue;
    const olx_vec3 expected = olx_grid_position(grid, i);
    if (!stands_on(p.x, expected.x, grid->spacing.x) || !stands_on(p.y, expected.y, grid->spacing.y) ||
        !stands_on(p.z, expected.z, grid->spacing.z)) {
      return olx_fail(failure, "%s: %s probe %u stands at (%g %g %g), not on its grid at (%g %g %g)", name, kind, i,
                      (double)p.x, (double)p.y, (double)p.z, (double)expected.x, (double)expected.y,
                      (double)expected.z);
    }
  }
  return OLX_OK;
}
