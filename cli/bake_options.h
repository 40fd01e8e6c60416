// The baking options that `bake` and `bench` share.
#ifndef OCTALUX_CLI_BAKE_OPTIONS_H
#define OCTALUX_CLI_BAKE_OPTIONS_H

#include "options.h"

#include <octalux/bake.h>
#include <octalux/limits.h>

typedef struct bake_options {
  olx_bake_settings settings; // the defaults, replaced where options were given
  const char *probes;         // file of probe positions, or NULL
} bake_options;

// The defaults before options are read. Grids have no probes until the scene is loaded.
bake_options bake_options_begin(void);

// Rows of an option table, which fill `b`.
#define BAKE_OPTION_ROWS(b) BAKE_BASIC_ROWS(b), GROUP_ROW("Quality"), BAKE_QUALITY_ROWS(b), RESEARCH_ROW, BAKE_RESEARCH_ROWS(b)

// clang-format off
#define BAKE_BASIC_ROWS(b)                                                                                             \
  {"--probes", OPTION_TEXT, &(b).probes, "FILE.json", "light field probes where `octalux place` put them", 0, 0},      \
  {"--grid", OPTION_GRID, (b).settings.grid.count, "4x4x4", "light field probes along x, y, z; default: the scene's", 1, 1024},       \
  {"--radiance-size", OPTION_POWER_OF_TWO, &(b).settings.radiance_size, "N", "texels along a map of light; default 512", OLX_RADIANCE_SIZE_LEAST, OLX_RADIANCE_SIZE_MOST}, \
  {"--relight", OPTION_FLAG, &(b).settings.relight, NULL, "also what it takes to change lights later", 0, 0},                   \
  {"--threads", OPTION_COUNT, &(b).settings.threads, "N", "default 0: every processor; the result is the same", 0, 4096}

#define BAKE_QUALITY_ROWS(b)                                                                                           \
  {"--noise", OPTION_REAL, &(b).settings.noise, "SHARE", "standard error of indirect light at most; default 0.02", 0, 0},       \
  {"--samples", OPTION_COUNT, &(b).settings.samples, "N", "samples along a texel's side; default 2", OLX_SAMPLES_LEAST, OLX_SAMPLES_MOST},                     \
  {"--light-samples", OPTION_COUNT, &(b).settings.light_samples, "N", "shadow rays a sample and area light; default 1", OLX_LIGHT_SAMPLES_LEAST, OLX_LIGHT_SAMPLES_MOST}, \
  {"--bounces", OPTION_COUNT, &(b).settings.bounces, "N", "bounces after direct light, while they bring some; default 32", 0, OLX_BOUNCES_MOST}, \
  {"--volume-cells", OPTION_COUNT, &(b).settings.volume_cells, "N",                                                             \
   "smallest cells of the irradiance volume along the space, at most; 0: no volume; default 32", 0, OLX_VOLUME_CELLS_MOST},              \
  {"--uncompressed", OPTION_FLAG, &(b).settings.uncompressed, NULL, "geometry, light and material as texels, not as 4 x 4 blocks", 0, 0}, \
  {"--seed", OPTION_COUNT, &(b).settings.seed, "N", "another one draws other random numbers; default 0", 0, UINT32_MAX}

#define BAKE_RESEARCH_ROWS(b)                                                                                          \
  {"--light", OPTION_CHOICE, &(b).settings.light, "cache|reference",                                                            \
   "indirect light on what probes see: solved once in the world, or paths from each texel, slow; default cache", 0, 0}, \
  {"--reference-paths", OPTION_COUNT, &(b).settings.reference_paths, "N", "paths a texel for --light reference; default 64", OLX_REFERENCE_PATHS_LEAST, OLX_REFERENCE_PATHS_MOST}, \
  {"--select", OPTION_CHOICES, &(b).settings.select_mask, "cage|voronoi|octree|bricks",                                         \
   "how probes are found, several with commas; default cage for a grid; bricks always", 0, 0},                         \
  {"--probe-light", OPTION_FLAG, &(b).settings.probe_light, NULL,                                                               \
   "also radiance as probes saw it and irradiance probes, for --hits stored, --diffuse irradiance", 0, 0},             \
  {"--irradiance-grid", OPTION_GRID, (b).settings.irradiance_grid.count, "4x4x4",                                                     \
   "irradiance probes (implies --probe-light); default: as --grid, or half its spacing", 1, 1024},                     \
  {"--irradiance-size", OPTION_POWER_OF_TWO, &(b).settings.irradiance_size, "N", "texels along a map of irradiance; default 128", OLX_IRRADIANCE_SIZE_LEAST, OLX_IRRADIANCE_SIZE_MOST}, \
  {"--irradiance", OPTION_CHOICE, &(b).settings.irradiance_form, "octahedral|sh2|sh3",                                          \
   "irradiance as maps, or as spherical harmonics of 2nd or 3rd order; default octahedral", 0, 0},                     \
  {"--bounce-gather", OPTION_CHOICE, &(b).settings.bounce_gather, "solved|irradiance|traced",                                   \
   "light of irradiance probes: solved for the scene, or bounces by their maps or rays; default solved", 0, 0},        \
  {"--no-fit", OPTION_FLAG_OFF, &(b).settings.fit, NULL, "keep irradiance exact at probes, unfitted to surfaces", 0, 0},         \
  {"--classic", OPTION_FLAG, &(b).settings.classic, NULL, "also maps for `render --method classic`", 0, 0},                     \
  {"--classic-size", OPTION_POWER_OF_TWO, &(b).settings.classic_size, "N", "texels along these; default 128", OLX_CLASSIC_SIZE_LEAST, OLX_CLASSIC_SIZE_MOST},         \
  {"--cube-size", OPTION_POWER_OF_TWO, &(b).settings.classic_cube_size, "N", "texels along a face of their cube maps; default 256", OLX_CLASSIC_CUBE_SIZE_LEAST, OLX_CLASSIC_CUBE_SIZE_MOST}, \
  {"--sharpness", OPTION_COUNT, &(b).settings.classic_sharpness, "N", "exponent of the filter from these; default: a texel wide", OLX_CLASSIC_SHARPNESS_LEAST, OLX_CLASSIC_SHARPNESS_MOST}
// clang-format on

double grid_probe_count(const olx_grid *grid);
// Number of irradiance probes; 0 without probe light.
double irradiance_probe_count(const olx_bake_settings *settings);
double light_probe_count(const olx_bake_settings *settings);

// Completes the settings by what depends on the scene: grids, and probes from a file. The caller releases what they
// hold after the bake.
olx_result resolve_bake_options(const olx_scene *scene, const command_line *line, bake_options *given);
void release_bake_settings(olx_bake_settings *settings);

#endif
