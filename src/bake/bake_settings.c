// Sets the defaults of a bake's settings, rejects invalid ones, and derives values from them. Nothing here reads the
// scene except for the grid that its description requests.
#include "bake/bake_settings.h"

#include "bake/selectors/selectors.h"
#include "core/result.h"
#include "core/vec.h"
#include "field/coded_probes.h"

#include <octalux/limits.h>

#include <math.h>
#include <string.h>

enum { CHEAP_PROBES = 64 }; // this many irradiance probes or fewer cost too little to economize on

olx_bake_settings olx_bake_settings_default(const olx_scene *scene) {
  olx_bake_settings settings = {.radiance_size = 512,
                                .irradiance_size = 128,
                                .samples = 2,
                                .light_samples = 1,
                                .bounces = 128,
                                .noise = 0.02f,
                                .reference_paths = 64,
                                .volume_cells = 32,
                                .fit = true,
                                .classic_size = 128,
                                .classic_cube_size = 256};
  if (!scene) return settings;
  if (olx_scene_probe_grid(scene, NULL, &settings.grid) != OLX_OK) settings.grid = (olx_grid){0};
  settings.irradiance_grid = olx_bake_irradiance_grid(&settings.grid);
  return settings;
}

bool olx_bake_keeps_probe_light(const olx_bake_settings *s) {
  const bool volume = s->volume_cells > 0 && s->light == OLX_LIGHT_CACHE;
  return s->probe_light || s->classic || !volume || s->irradiance_form != OLX_IRRADIANCE_OCTAHEDRAL ||
         s->bounce_gather != OLX_GATHER_SOLVED;
}

olx_grid olx_bake_irradiance_grid(const olx_grid *grid) {
  const float spacing[3] = {grid->spacing.x, grid->spacing.y, grid->spacing.z};
  olx_grid finer = *grid;
  float halved[3];
  uint64_t probes = 1;
  for (uint32_t axis = 0; axis < 3; axis++) {
    const bool single = grid->count[axis] < 2;
    finer.count[axis] = single ? grid->count[axis] : 2 * grid->count[axis] - 1;
    halved[axis] = single ? spacing[axis] : 0.5f * spacing[axis];
    probes *= finer.count[axis];
    if (probes > CHEAP_PROBES) return *grid;
  }
  finer.spacing = olx_v3(halved[0], halved[1], halved[2]);
  return finer;
}

static olx_result check_grid(const olx_grid *grid, const char *name) {
  uint64_t probes = 1;
  const float spacing[3] = {grid->spacing.x, grid->spacing.y, grid->spacing.z};
  for (uint32_t axis = 0; axis < 3; axis++) {
    if (grid->count[axis] == 0) return olx_fail(OLX_ERROR_ARGUMENT, "bake: %s: a count of 0 probes", name);
    probes *= grid->count[axis];
    if (probes > OLX_BAKE_PROBES_MOST)
      return olx_fail(OLX_ERROR_ARGUMENT, "bake: %s: more than %d probes", name, OLX_BAKE_PROBES_MOST);
    if (grid->count[axis] > 1 && spacing[axis] == 0.0f) {
      return olx_fail(
          OLX_ERROR_ARGUMENT,
          "bake: %s: %u probes at the same %c: a flat scene needs one probe along that axis, other bounds of "
          "its probes, or probes that `octalux place` placed",
          name, grid->count[axis], "xyz"[axis]);
    }
    if (!isfinite(spacing[axis]) || spacing[axis] < 0.0f) {
      return olx_fail(OLX_ERROR_ARGUMENT, "bake: %s: spacing %g along %c", name, (double)spacing[axis], "xyz"[axis]);
    }
  }
  const olx_vec3 last = {grid->origin.x + spacing[0] * (float)(grid->count[0] - 1),
                         grid->origin.y + spacing[1] * (float)(grid->count[1] - 1),
                         grid->origin.z + spacing[2] * (float)(grid->count[2] - 1)};
  if (!olx_is_position(grid->origin) || !olx_is_position(last)) {
    return olx_fail(OLX_ERROR_ARGUMENT, "bake: %s: its probes are not within 2e7 m", name);
  }
  return OLX_OK;
}

static olx_result check_size(uint32_t size, uint32_t least, uint32_t most, const char *name) {
  if (size >= least && size <= most && (size & (size - 1)) == 0) return OLX_OK;
  return olx_fail(OLX_ERROR_ARGUMENT, "bake: %s of %u texels: must be a power of two from %u to %u", name, size, least,
                  most);
}

static olx_result check_range(uint32_t value, uint32_t least, uint32_t most, const char *name) {
  if (value >= least && value <= most) return OLX_OK;
  return olx_fail(OLX_ERROR_ARGUMENT, "bake: %s %u: must be from %u to %u", name, value, least, most);
}

static olx_result check_probes(const olx_bake_settings *settings) {
  if (!settings->probes) return check_grid(&settings->grid, "probe grid");
  OLX_TRY(check_range(settings->probe_count, 1, OLX_BAKE_PROBES_MOST, "probes"));
  for (uint32_t i = 0; i < settings->probe_count; i++) {
    if (!olx_is_position(settings->probes[i])) {
      return olx_fail(OLX_ERROR_ARGUMENT, "bake: the position of probe %u is not within 2e7 m", i);
    }
  }
  return OLX_OK;
}

static olx_result check_select(const olx_bake_settings *settings) {
  const uint32_t mask = settings->select_mask;
  if (mask & ~olx_selectors_known()) return olx_fail(OLX_ERROR_ARGUMENT, "bake: unknown selectors (mask %#x)", mask);
  if (settings->probes && (mask & 1u << OLX_SELECT_CAGE)) {
    return olx_fail(OLX_ERROR_ARGUMENT, "bake: the selector 'cage' needs probes on a grid");
  }
  return OLX_OK;
}

static olx_result check_classic(const olx_bake_settings *settings) {
  if (!settings->classic) return OLX_OK;
  OLX_TRY(check_size(settings->classic_size, OLX_CLASSIC_SIZE_LEAST, OLX_CLASSIC_SIZE_MOST, "classic size"));
  OLX_TRY(
      check_size(settings->classic_cube_size, OLX_CLASSIC_CUBE_SIZE_LEAST, OLX_CLASSIC_CUBE_SIZE_MOST, "cube size"));
  if (!settings->classic_sharpness) return OLX_OK;
  return check_range(settings->classic_sharpness, OLX_CLASSIC_SHARPNESS_LEAST, OLX_CLASSIC_SHARPNESS_MOST, "sharpness");
}

static olx_result check_relight(const olx_bake_settings *settings) {
  if (!settings->relight || settings->light == OLX_LIGHT_CACHE) return OLX_OK;
  return olx_fail(OLX_ERROR_ARGUMENT, "bake: relighting needs the light of the scene, not the reference");
}

static olx_result check_probe_light(const olx_bake_settings *settings) {
  OLX_TRY(check_grid(&settings->irradiance_grid, "irradiance grid"));
  OLX_TRY(
      check_size(settings->irradiance_size, OLX_IRRADIANCE_SIZE_LEAST, OLX_IRRADIANCE_SIZE_MOST, "irradiance size"));
  OLX_TRY(check_range(settings->irradiance_form, OLX_IRRADIANCE_OCTAHEDRAL, OLX_IRRADIANCE_SH3, "form of irradiance"));
  return check_range(settings->bounce_gather, OLX_GATHER_SOLVED, OLX_GATHER_TRACED, "way to gather bounces");
}

static olx_result check_raster(const olx_bake_raster *raster) {
  if (!raster || (raster->name && *raster->name && raster->look && !strpbrk(raster->name, "\r\n"))) return OLX_OK;
  return olx_fail(OLX_ERROR_ARGUMENT, "bake: a raster without a name of one line, or without its function");
}

olx_result olx_bake_check_settings(const olx_bake_settings *settings) {
  OLX_TRY(check_raster(settings->raster));
  OLX_TRY(check_probes(settings));
  OLX_TRY(check_select(settings));
  OLX_TRY(check_size(settings->radiance_size, OLX_RADIANCE_SIZE_LEAST, OLX_RADIANCE_SIZE_MOST, "radiance size"));
  if (olx_bake_keeps_probe_light(settings)) OLX_TRY(check_probe_light(settings));
  OLX_TRY(check_relight(settings));
  OLX_TRY(check_classic(settings));
  OLX_TRY(check_range(settings->light, OLX_LIGHT_CACHE, OLX_LIGHT_REFERENCE, "kind of light"));
  if (!(settings->noise >= OLX_NOISE_LEAST && settings->noise <= OLX_NOISE_MOST))
    return olx_fail(OLX_ERROR_ARGUMENT, "bake: noise must be %g to %g, not %g", (double)OLX_NOISE_LEAST,
                    (double)OLX_NOISE_MOST, (double)settings->noise);
  OLX_TRY(
      check_range(settings->reference_paths, OLX_REFERENCE_PATHS_LEAST, OLX_REFERENCE_PATHS_MOST, "reference paths"));
  OLX_TRY(check_range(settings->volume_cells, 0, OLX_VOLUME_CELLS_MOST, "cells of the volume"));
  OLX_TRY(check_range(settings->samples, OLX_SAMPLES_LEAST, OLX_SAMPLES_MOST, "samples"));
  OLX_TRY(check_range(settings->light_samples, OLX_LIGHT_SAMPLES_LEAST, OLX_LIGHT_SAMPLES_MOST, "light samples"));
  return check_range(settings->bounces, 0, OLX_BOUNCES_MOST, "bounces");
}

uint32_t olx_bake_select_mask(const olx_bake_settings *settings) {
  const uint32_t *count = settings->grid.count;
  const uint64_t probes = settings->probes ? settings->probe_count : (uint64_t)count[0] * count[1] * count[2];
  const uint32_t bricks = probes <= OLX_MAX_CODED_PROBES ? 1u << OLX_SELECT_BRICKS : 0;
  if (settings->select_mask) return settings->select_mask | bricks;
  return settings->probes ? bricks : 1u << OLX_SELECT_CAGE | bricks;
}

bool olx_bake_is_solved(const olx_bake_settings *s) {
  return s->light == OLX_LIGHT_CACHE && s->bounce_gather == OLX_GATHER_SOLVED;
}
