// Reads the baking options that `bake` and `bench` share, and turns them into settings, with defaults from the scene.
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

// Loads the positions from a file that `octalux place` wrote.
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

bake_options bake_options_begin(void) { return (bake_options){.settings = olx_bake_settings_default(NULL)}; }

// Whether the command line requests probe light; options for how it is computed imply it.
static bool asks_for_probe_light(const command_line *line) {
  static const char *const names[] = {"--probe-light", "--irradiance-grid", "--irradiance-size",
                                      "--no-fit",      "--irradiance",      "--bounce-gather"};
  for (size_t i = 0; i < sizeof names / sizeof *names; ++i) {
    if (was_given(line, names[i])) return true;
  }
  return false;
}

// Creates the grid with the requested number of probes.
static olx_result place_grid(const olx_scene *scene, olx_grid *grid) {
  const uint32_t count[3] = {grid->count[0], grid->count[1], grid->count[2]};
  return olx_scene_probe_grid(scene, count, grid);
}

olx_result resolve_bake_options(const olx_scene *scene, const command_line *line, bake_options *given) {
  olx_bake_settings *settings = &given->settings;
  olx_result result = OLX_OK;
  if (was_given(line, "--grid")) result = place_grid(scene, &settings->grid);
  else settings->grid = olx_bake_settings_default(scene).grid;
  if (result != OLX_OK) return result;
  if (was_given(line, "--irradiance-grid")) result = place_grid(scene, &settings->irradiance_grid);
  else settings->irradiance_grid = olx_bake_irradiance_grid(&settings->grid);
  if (result != OLX_OK) return result;
  settings->probe_light = asks_for_probe_light(line);
  return given->probes ? load_probes(scene, given->probes, settings) : OLX_OK;
}
