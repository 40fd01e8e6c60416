// Writes a field's irradiance volume as ambient cubes in a KTX 2.0 texture, for engines that read such volumes.
#include "core/hooks.h"
#include "core/pack.h"
#include "core/result.h"
#include "export/cube_fit.h"
#include "export/ktx2_file.h"
#include "field/field_data.h"

#include <octalux/export.h>

#include <cjson/cJSON.h>

enum { DEFAULT_VOXELS = 32 };

// How far the box reaches beyond the scene's bounds, in shares of their longest side.
static const float MARGIN = 0x1p-10f;

static const char TRANSFORM_KEY[] = "octalux.volume", UNIT[] = "irradiance / pi, W/(sr m^2)";

olx_cubes_settings olx_cubes_settings_default(void) { return (olx_cubes_settings){.fit = true}; }

// ---- The grid

static bool has_size(const olx_cubes_settings *s) { return s->size[0] || s->size[1] || s->size[2]; }

static olx_result check_size(const uint32_t size[3]) {
  static const uint32_t parts[3] = {1, 2, 3};
  bool fits = (uint64_t)size[0] * size[1] * size[2] <= OLX_CUBES_MOST_VOXELS;
  for (uint32_t i = 0; i < 3; i++) fits = fits && size[i] > 0 && size[i] * parts[i] <= OLX_CUBES_MOST_TEXELS;
  if (fits) return OLX_OK;
  return olx_fail(OLX_ERROR_ARGUMENT, "%ux%ux%u voxels: each at least 1, at most %dx%dx%d, and at most %u in all",
                  size[0], size[1], size[2], OLX_CUBES_MOST_TEXELS, OLX_CUBES_MOST_TEXELS / 2,
                  OLX_CUBES_MOST_TEXELS / 3, OLX_CUBES_MOST_VOXELS);
}

static olx_result check_settings(const olx_cubes_settings *s) {
  if (s->spacing_metres >= 0.0f && isfinite(s->spacing_metres) && !(has_size(s) && s->spacing_metres > 0.0f)) {
    return OLX_OK;
  }
  return olx_fail(OLX_ERROR_ARGUMENT, "voxels of %g m: either a size or a spacing above 0", (double)s->spacing_metres);
}

// Finds the sides of the scene's bounds with their margin.
static void find_extents(const olx_field *field, float extents[3]) {
  const olx_vec3 bounds = olx_sub(field->info.scene.bounds_max, field->info.scene.bounds_min);
  olx_store3(extents, olx_add(bounds, olx_splat(2.0f * MARGIN * olx_max3(bounds))));
}

// Divides the extents into voxels: as many as the settings say, or cubes, as many as are needed.
static void divide(const olx_cubes_settings *s, const float extents[3], olx_cube_grid *grid) {
  const float longest = fmaxf(extents[0], fmaxf(extents[1], extents[2]));
  const float side = s->spacing_metres > 0.0f ? s->spacing_metres : longest / DEFAULT_VOXELS;
  float spacing[3];
  for (uint32_t i = 0; i < 3; i++) {
    const float count = ceilf(extents[i] / side * (1.0f - 0x1p-20f)); // rounding adds no voxel
    grid->size[i] = has_size(s) ? s->size[i] : (uint32_t)olx_clamp(count, 1.0f, 1e6f);
    spacing[i] = has_size(s) ? extents[i] / (float)grid->size[i] : side;
  }
  grid->spacing = olx_load3(spacing);
}

static olx_result choose_grid(const olx_field *field, const olx_cubes_settings *settings, olx_cube_grid *grid) {
  float extents[3];
  OLX_TRY(check_settings(settings));
  find_extents(field, extents);
  divide(settings, extents, grid);
  OLX_TRY(check_size(grid->size));
  const olx_vec3 middle = olx_scale(olx_add(field->info.scene.bounds_min, field->info.scene.bounds_max), 0.5f);
  const olx_vec3 size = olx_v3((float)grid->size[0], (float)grid->size[1], (float)grid->size[2]);
  grid->low = olx_madd(middle, olx_mul(size, grid->spacing), -0.5f);
  return OLX_OK;
}

static void describe_grid(const olx_field *field, const olx_cube_grid *grid, olx_cubes_info *info) {
  float low[3], high[3], spacing[3];
  olx_store3(low, field->info.scene.bounds_min);
  olx_store3(high, field->info.scene.bounds_max);
  olx_store3(spacing, grid->spacing);
  for (uint32_t i = 0; i < 3; i++) {
    info->size[i] = grid->size[i];
    info->scale[i] = (double)spacing[i] * grid->size[i];
    info->translation[i] = field->origin[i] + 0.5 * ((double)low[i] + (double)high[i]);
  }
}

// ---- The texture

// Returns the index of a voxel's texel for a side.
static size_t texel_of(const olx_cube_grid *g, size_t voxel, uint32_t side) {
  const size_t x = voxel % g->size[0], y = voxel / g->size[0] % g->size[1], z = voxel / g->size[0] / g->size[1];
  const size_t row = y + (side & 1) * g->size[1], slice = z + (side / 2) * (size_t)g->size[2];
  return x + g->size[0] * (row + 2 * (size_t)g->size[1] * slice);
}

static void pack_texels(const olx_cubes *cubes, uint32_t *texels) {
  for (uint32_t side = 0; side < OLX_CUBE_SIDES; side++) {
    for (size_t i = 0; i < cubes->voxels; i++) {
      const olx_vec3 value = cubes->values[side * cubes->voxels + i];
      texels[texel_of(&cubes->grid, i, side)] = olx_rgb9e5_pack(olx_scale(value, 1.0f / OLX_PI));
    }
  }
}

// Returns the text of the file's own key; NULL when memory runs out. The caller frees it with cJSON_free.
static char *transform_text(const olx_cubes_info *info) {
  cJSON *object = cJSON_CreateObject();
  cJSON_AddItemToObject(object, "translation", cJSON_CreateDoubleArray(info->translation, 3));
  cJSON_AddItemToObject(object, "scale", cJSON_CreateDoubleArray(info->scale, 3));
  cJSON_AddStringToObject(object, "unit", UNIT);
  char *text = cJSON_PrintUnformatted(object);
  cJSON_Delete(object);
  return text;
}

static olx_result write_cubes(const olx_cubes *cubes, bool zstd, const char *path, olx_cubes_info *info) {
  const uint32_t *size = cubes->grid.size;
  uint32_t *texels = olx_allocate(OLX_CUBE_SIDES * cubes->voxels, sizeof *texels);
  char *text = transform_text(info);
  olx_result result = OLX_ERROR_MEMORY;
  if (texels && text) {
    pack_texels(cubes, texels);
    const olx_ktx2_texture texture = {.size = {size[0], 2 * size[1], 3 * size[2]},
                                      .texels = texels,
                                      .key = TRANSFORM_KEY,
                                      .text = text,
                                      .zstd = zstd};
    result = olx_ktx2_write(&texture, path, &info->file_bytes);
  } else {
    olx_fail(result, "%s: out of memory", path);
  }
  cJSON_free(text);
  olx_release(texels);
  return result;
}

// ---- The export

static uint32_t count_inside(const olx_cubes *cubes) {
  uint32_t inside = 0;
  for (size_t i = 0; i < cubes->voxels; i++) inside += !cubes->served[i];
  return inside;
}

static olx_result fill_cubes(const olx_field *field, const olx_cubes_settings *settings, olx_cubes *cubes,
                             olx_task *task, olx_cubes_info *info) {
  olx_cube_points points = {.count = 0};
  OLX_TRY(olx_cubes_capture(field, cubes, settings->threads));
  info->inside = count_inside(cubes);
  olx_result result = olx_cube_points_collect(field, &cubes->grid, settings->threads, &points);
  if (result == OLX_OK) {
    const olx_cubes_errors before = olx_cubes_compare(cubes, &points);
    info->points = before.points;
    info->captured_error = before.relative_mse;
    if (settings->fit) result = olx_cubes_fit(cubes, &points, settings->threads, task);
    info->written_error = olx_cubes_compare(cubes, &points).relative_mse;
  }
  olx_cube_points_free(&points);
  return result;
}

static olx_result export_grid(const olx_field *field, const olx_cubes_settings *settings, const olx_cube_grid *grid,
                              const char *path, olx_task *task, olx_cubes_info *info) {
  olx_cubes cubes;
  olx_result result = olx_cubes_create(grid, &cubes);
  if (result == OLX_OK) result = fill_cubes(field, settings, &cubes, task, info);
  if (result == OLX_OK) result = write_cubes(&cubes, settings->zstd, path, info);
  olx_cubes_free(&cubes);
  return result;
}

olx_result olx_export_ktx2(const olx_field *field, const olx_cubes_settings *settings, const char *path,
                           const olx_progress *progress, olx_cubes_info *info) {
  olx_cubes_info unread;
  olx_cube_grid grid;
  olx_task task;
  if (!info) info = &unread;
  *info = (olx_cubes_info){.points = 0};
  if (!field->volume.header) {
    return olx_fail(OLX_ERROR_ARGUMENT, "%s: baked without an irradiance volume (bake --volume-cells)", field->name);
  }
  OLX_TRY(choose_grid(field, settings, &grid));
  describe_grid(field, &grid, info);
  olx_task_begin(&task, progress, "fit", OLX_CUBE_FIT_ROUNDS);
  const olx_result result = export_grid(field, settings, &grid, path, &task, info);
  olx_task_end(&task);
  return result;
}
