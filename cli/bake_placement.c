// Places the probes of a bake as `octalux place` does, where neither the command line nor the scene says where they
// are.
#include "bake_placement.h"

#include "commands.h"
#include "report.h"

#include <octalux/place.h>

#include <stdio.h>

bool leaves_probes_open(const olx_scene *scene, const command_line *line, const bake_options *given) {
  const olx_scene_info info = olx_scene_describe(scene);
  const bool needs_grid = given->settings.select_mask & 1u << OLX_SELECT_CAGE;
  return !given->probes && !was_given(line, "--grid") && !info.has_probe_volume && !info.has_probe_count && !needs_grid;
}

olx_result place_probes(const olx_scene *scene, double budget_mb, bake_options *given) {
  olx_place_settings settings = olx_place_settings_default(scene);
  settings.threads = given->settings.threads;
  settings.resolution = given->settings.radiance_size;
  settings.budget_mb = budget_mb;
  progress_line line;
  progress_begin(&line, "bake", false);
  const olx_progress progress = progress_of(&line);
  olx_probe_set set;
  olx_result result = olx_place(scene, &settings, &progress, &set);
  progress_end(&line);
  if (result != OLX_OK) return result;
  result = take_probes(&set, &given->settings);
  olx_probe_set_free(&set);
  return result;
}

int report_placement(olx_result result) {
  return result == OLX_ERROR_CANCELLED ? failure("bake", "interrupted, nothing written") : library_failure("bake");
}

int place_open_probes(const olx_scene *scene, bake_options *given) {
  const olx_result result = place_probes(scene, 0.0, given);
  const uint32_t *count = given->settings.grid.count;
  if (result == OLX_ERROR_EMPTY) {
    warn("%s; probes are on a grid of %ux%ux%u over the bounds instead", olx_last_error(), count[0], count[1],
         count[2]);
    return EXIT_DONE;
  }
  if (result != OLX_OK) return report_placement(result);
  if (!is_quiet()) {
    fprintf(stderr, "octalux bake: placed %u probes; `octalux place` and --probes, or --grid, choose others\n",
            given->settings.probe_count);
  }
  return EXIT_DONE;
}
