// Reads the baking options that `bake` and `bench` share, and turns them into settings, with defaults from the scene.
#include "bake_options.h"

#include <octalux/limits.h>

#include <stdio.h>
#include <stdlib.h>

const option bake_basic_options[] = {
    {"--probes", OPTION_TEXT, offsetof(bake_options, probes), "FILE.json",
     "light field probes where `octalux place` put them"},
    {"--grid", OPTION_GRID, offsetof(bake_options, settings.grid.count), "4x4x4",
     "light field probes along x, y, z; default: the scene's, or else probes as `octalux place` places them", 1, 1024},
    {"--radiance-size", OPTION_POWER_OF_TWO, offsetof(bake_options, settings.radiance_size), "N",
     "texels along a map of light; default 512", OLX_RADIANCE_SIZE_LEAST, OLX_RADIANCE_SIZE_MOST},
    {"--relight", OPTION_FLAG, offsetof(bake_options, settings.relight), NULL,
     "also store the data for changing lights at run time"},
    {0}};

const option bake_quality_options[] = {
    {"--noise", OPTION_REAL, offsetof(bake_options, settings.noise), "SHARE",
     "standard error of indirect light at most; default 0.02", .least = OLX_NOISE_LEAST, .most = OLX_NOISE_MOST},
    {"--samples", OPTION_COUNT, offsetof(bake_options, settings.samples), "N",
     "samples along a texel's side; default 2", OLX_SAMPLES_LEAST, OLX_SAMPLES_MOST},
    {"--light-samples", OPTION_COUNT, offsetof(bake_options, settings.light_samples), "N",
     "shadow rays for each sample and each group of lights with area; default 1", OLX_LIGHT_SAMPLES_LEAST,
     OLX_LIGHT_SAMPLES_MOST},
    {"--bounces", OPTION_COUNT, offsetof(bake_options, settings.bounces), "N",
     "most bounces after direct light; they end when they bring little light; default 128", 0, OLX_BOUNCES_MOST},
    {"--volume-cells", OPTION_COUNT, offsetof(bake_options, settings.volume_cells), "N",
     "greatest number of smallest cells of the irradiance volume along the space, and at most one for 16 texels of a "
     "map's side; 0: no volume; default 32",
     0, OLX_VOLUME_CELLS_MOST},
    {"--uncompressed", OPTION_FLAG, offsetof(bake_options, settings.uncompressed), NULL,
     "geometry, light and material as texels, not as 4 x 4 blocks"},
    {"--seed", OPTION_COUNT, offsetof(bake_options, settings.seed), "N", "seed of all random numbers; default 0", 0,
     UINT32_MAX},
    {0}};

const option bake_research_options[] = {
    {"--light", OPTION_CHOICE, offsetof(bake_options, settings.light), "cache|reference",
     "indirect light on what probes see: solved once in the world, or paths from each texel, slow; default cache"},
    {"--reference-paths", OPTION_COUNT, offsetof(bake_options, settings.reference_paths), "N",
     "paths a texel for --light reference; default 64", OLX_REFERENCE_PATHS_LEAST, OLX_REFERENCE_PATHS_MOST},
    {"--select", OPTION_CHOICES, offsetof(bake_options, settings.select_mask), "cage|voronoi|octree|bricks",
     "selectors of probes to store, separated by commas; default: cage for a grid; bricks are always stored"},
    {"--probe-light", OPTION_FLAG, offsetof(bake_options, settings.probe_light), NULL,
     "also radiance as probes saw it and irradiance probes, for --hits stored, --diffuse irradiance"},
    {"--irradiance-grid", OPTION_GRID, offsetof(bake_options, settings.irradiance_grid.count), "4x4x4",
     "irradiance probes (implies --probe-light); default: as --grid, or half its spacing", 1, 1024},
    {"--irradiance-size", OPTION_POWER_OF_TWO, offsetof(bake_options, settings.irradiance_size), "N",
     "texels along a map of irradiance; default 128", OLX_IRRADIANCE_SIZE_LEAST, OLX_IRRADIANCE_SIZE_MOST},
    {"--irradiance", OPTION_CHOICE, offsetof(bake_options, settings.irradiance_form), "octahedral|sh2|sh3",
     "irradiance as maps, or as spherical harmonics of 2nd or 3rd order; default octahedral"},
    {"--bounce-gather", OPTION_CHOICE, offsetof(bake_options, settings.bounce_gather), "solved|irradiance|traced",
     "light of irradiance probes: solved for the scene, or bounces by their maps or rays; default solved"},
    {"--no-fit", OPTION_FLAG_OFF, offsetof(bake_options, settings.fit), NULL,
     "keep irradiance exact at probes, unfitted to surfaces"},
    {"--classic", OPTION_FLAG, offsetof(bake_options, settings.classic), NULL,
     "also maps for `render --method classic`"},
    {"--classic-size", OPTION_POWER_OF_TWO, offsetof(bake_options, settings.classic_size), "N",
     "texels along a classic map; default 128", OLX_CLASSIC_SIZE_LEAST, OLX_CLASSIC_SIZE_MOST},
    {"--cube-size", OPTION_POWER_OF_TWO, offsetof(bake_options, settings.classic_cube_size), "N",
     "texels along a face of the cube maps of classic maps; default 256", OLX_CLASSIC_CUBE_SIZE_LEAST,
     OLX_CLASSIC_CUBE_SIZE_MOST},
    {"--sharpness", OPTION_COUNT, offsetof(bake_options, settings.classic_sharpness), "N",
     "exponent of the filter from cube maps to classic maps; default: a texel wide", OLX_CLASSIC_SHARPNESS_LEAST,
     OLX_CLASSIC_SHARPNESS_MOST},
    {0}};

double grid_probe_count(const olx_grid *grid) {
  return (double)grid->count[0] * (double)grid->count[1] * (double)grid->count[2];
}

double irradiance_probe_count(const olx_bake_settings *settings) {
  return olx_bake_keeps_probe_light(settings) ? grid_probe_count(&settings->irradiance_grid) : 0.0;
}

double light_probe_count(const olx_bake_settings *settings) {
  return settings->probes ? (double)settings->probe_count : grid_probe_count(&settings->grid);
}

olx_result take_probes(const olx_probe_set *set, olx_bake_settings *settings) {
  olx_vec3 *positions = malloc(set->count * sizeof *positions);
  for (uint32_t i = 0; positions && i < set->count; ++i) positions[i] = set->probes[i].position;
  settings->probes = positions;
  settings->probe_count = set->count;
  return positions ? OLX_OK : OLX_ERROR_MEMORY;
}

// Loads the positions from a file that `octalux place` wrote.
static olx_result load_probes(const olx_scene *scene, const char *path, olx_bake_settings *settings) {
  olx_probe_set set;
  const olx_scene_info info = olx_scene_describe(scene);
  const olx_result result = olx_probe_set_load(path, info.origin, &set);
  if (result != OLX_OK) return result;
  if (set.scene_hash && set.scene_hash != info.hash) {
    warn("%s: placed in another scene, or in another version of this one", path);
  }
  const olx_result taken = take_probes(&set, settings);
  olx_probe_set_free(&set);
  return taken;
}

void release_bake_settings(olx_bake_settings *settings) {
  free((void *)(uintptr_t)settings->probes);
  settings->probes = NULL;
}

bake_options bake_options_begin(void) { return (bake_options){.settings = olx_bake_settings_default(NULL)}; }

// Returns whether the command line requests probe light; options for how it is computed imply it.
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
