// The baking options that `bake` and `bench` share.
#ifndef OCTALUX_CLI_BAKE_OPTIONS_H
#define OCTALUX_CLI_BAKE_OPTIONS_H

#include "options.h"

#include <octalux/bake.h>
#include <octalux/place.h>

typedef struct bake_options {
  olx_bake_settings settings; // the defaults, replaced where options were given
  const char *probes;         // file of probe positions, or NULL
} bake_options;

// Returns the defaults before options are read. Grids have no probes until the scene is loaded.
bake_options bake_options_begin(void);

// Options that fill a bake_options: the most common ones, which go before `threads_option`, those of quality, and those
// of research.
extern const option bake_basic_options[], bake_quality_options[], bake_research_options[];

double grid_probe_count(const olx_grid *grid);
// Returns the number of irradiance probes; 0 without probe light.
double irradiance_probe_count(const olx_bake_settings *settings);
double light_probe_count(const olx_bake_settings *settings);

// Completes the settings by what depends on the scene: grids, and probes from a file. The caller releases what they
// hold after the bake.
olx_result resolve_bake_options(const olx_scene *scene, const command_line *line, bake_options *given);
// Copies the positions of a set into the settings.
olx_result take_probes(const olx_probe_set *set, olx_bake_settings *settings);
void release_bake_settings(olx_bake_settings *settings);

#endif
