// Reads the options of baking that `bake` and `bench` share, and turns them into settings, with the scene's own where
// nothing was given.
#include "bake_options.h"

#include <octalux/place.h>

#include <stdio.h>
#include <stdlib.h>

double grid_probe_count(const olx_grid *grid) {
  return (double)grid->count[0] * (double)grid->count[1] * (double)grid->count[2];
}

double irradiance_probe_count(const olx_bake_settings *settings) {
  return olx_bake_keeps_probe_light(settings) ? grid_probe_count(&settings->irradiance_grid) : 0.0;
}

double light_probe_count(const olx_bake_settings *settings) {
  return settings->probes ? (double)settings->probe_count : grid_probe_count(&settings->grid);
}

// The positions of a file that `octalux place` wrote.
static olx_result load_probes(const olx_scene *scene, const char *path, olx_bake_settings *settings) {
  olx_probe_set set;
  const olx_scene_info info = olx_scene_describe(scene);
  const olx_result result = olx_probe_set_load(path, info.origin, &set);
  if (result != OLX_OK) return result;
  if (set.scene_hash && set.scene_hash != info.hash) {
    fprintf(stderr, "octalux: %s: placed in another scene, or in another version of this one\n", path);
  }
  olx_vec3 *positions = malloc(set.count * sizeof *positions);
  for (uint32_t i = 0; positions && i < set.count; ++i) positions[i] = set.probes[i].position;
  settings->probes = positions;
  settings->probe_count = set.count;
  olx_probe_set_free(&set);
  return positions ? OLX_OK : OLX_ERROR_MEMORY;
}

void release_bake_settings(olx_bake_settings *settings) {
  free((void *)(uintptr_t)settings->probes);
  settings->probes = NULL;
}

// Options that say how probe light is made imply that it is wanted.
static bool asks_for_probe_light(const bake_options *given) {
  return given->probe_light || given->irradiance_grid[0] || given->irradiance_size || given->no_fit ||
         given->irradiance_form != UINT32_MAX || given->bounce_gather != UINT32_MAX;
}

olx_result resolve_bake_options(const olx_scene *scene, const bake_options *given, olx_bake_settings *settings) {
  *settings = olx_bake_settings_default(scene);
  if (given->grid[0]) {
    const olx_result result = olx_scene_probe_grid(scene, given->grid, &settings->grid);
    if (result != OLX_OK) return result;
    settings->irradiance_grid = olx_bake_irradiance_grid(&settings->grid);
  }
  if (given->irradiance_grid[0]) {
    const olx_result result = olx_scene_probe_grid(scene, given->irradiance_grid, &settings->irradiance_grid);
    if (result != OLX_OK) return result;
  }
  if (given->radiance_size) settings->radiance_size = given->radiance_size;
  if (given->irradiance_size) settings->irradiance_size = given->irradiance_size;
  if (given->irradiance_form != UINT32_MAX) settings->irradiance_form = (olx_irradiance_form)given->irradiance_form;
  if (given->bounces != UINT32_MAX) settings->bounces = given->bounces;
  if (given->samples) settings->samples = given->samples;
  if (given->light_samples) settings->light_samples = given->light_samples;
  settings->select_mask = given->select_mask;
  settings->fit = !given->no_fit;
  if (given->bounce_gather != UINT32_MAX) settings->bounce_gather = (olx_bounce_gather)given->bounce_gather;
  settings->probe_light = asks_for_probe_light(given);
  settings->light = (olx_bake_light)given->light;
  if (given->noise > 0.0f) settings->noise = given->noise;
  if (given->reference_paths) settings->reference_paths = given->reference_paths;
  if (given->volume_cells != UINT32_MAX) settings->volume_cells = given->volume_cells;
  settings->classic = given->classic;
  settings->relight = given->relight;
  settings->uncompressed = given->uncompressed;
  if (given->classic_size) settings->classic_size = given->classic_size;
  if (given->classic_cube_size) settings->classic_cube_size = given->classic_cube_size;
  settings->classic_sharpness = given->classic_sharpness;
  settings->seed = given->seed;
  settings->threads = given->threads;
  return given->probes ? load_probes(scene, given->probes, settings) : OLX_OK;
}
