// Placing the probes of a bake for which nothing says where they are.
#ifndef OCTALUX_CLI_BAKE_PLACEMENT_H
#define OCTALUX_CLI_BAKE_PLACEMENT_H

#include "bake_options.h"

// Returns whether nothing says where the light field probes are: neither --probes nor --grid, nor the scene. Cages are
// those of a grid, so --select cage asks for one.
bool leaves_probes_open(const olx_scene *scene, const command_line *line, const bake_options *given);
// Places probes as `octalux place` does by default, for maps of the chosen size; as many as fit into a budget of a
// default bake's maps, where it is not 0. The settings own the positions (release_bake_settings).
olx_result place_probes(const olx_scene *scene, double budget_mb, bake_options *given);
// Places probes without a budget and prints on standard error how many there are, unless --quiet. Where there is
// nowhere to place any, the grid stays, with a warning. Returns EXIT_DONE, or the exit code after a line with the
// reason.
int place_open_probes(const olx_scene *scene, bake_options *given);
// Prints why a placement failed; returns the exit code.
int report_placement(olx_result result);

#endif
