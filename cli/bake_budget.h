// Choosing the probes and the maps of a bake by the megabytes that its field may take.
#ifndef OCTALUX_CLI_BAKE_BUDGET_H
#define OCTALUX_CLI_BAKE_BUDGET_H

#include "bake_options.h"

// Chooses what the command line leaves open, after resolve_bake_options: probes where neither --probes nor --grid is
// given, as `octalux place` does by default, and the largest maps that fit where --radiance-size is not given. With
// --radiance-size, probes are chosen by the budget. Prints the result on standard error unless --quiet. Returns
// EXIT_DONE, or the exit code after a line with the reason: what was given does not fit.
int fit_bake_budget(const olx_scene *scene, const command_line *line, double budget_mb, bake_options *given);

#endif
