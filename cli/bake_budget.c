// Fits a bake into a budget of megabytes: by the number of probes, and by the size of maps.
#include "bake_budget.h"

#include "bake_placement.h"
#include "commands.h"

#include <stdio.h>

// Finds the size that a field is expected to have. Whether the machine suffices is checked by the bake, or reported by
// --dry-run.
static olx_result expect_size(const olx_scene *scene, const olx_bake_settings *settings, double *megabytes) {
  olx_bake_sizes sizes;
  const olx_result result = olx_bake_measure(scene, settings, "", &sizes);
  *megabytes = (double)sizes.expected_bytes * 1e-6;
  return sizes.probes ? OLX_OK : result;
}

// Drops the last probes, which add least, until a field of the others is expected to fit: a bake may store more than a
// default one, such as probe light.
static olx_result drop_probes(const olx_scene *scene, double budget_mb, olx_bake_settings *settings) {
  uint32_t least = 1, most = settings->probe_count; // a number of probes that fits is within these bounds
  double megabytes;
  olx_result result = expect_size(scene, settings, &megabytes);
  if (result != OLX_OK || megabytes <= budget_mb) return result;
  for (most--; least < most && result == OLX_OK;) {
    settings->probe_count = least + (most - least + 1) / 2;
    result = expect_size(scene, settings, &megabytes);
    if (megabytes <= budget_mb) least = settings->probe_count;
    else most = settings->probe_count - 1;
  }
  settings->probe_count = least;
  return result;
}

static int refuse(const olx_bake_settings *settings, double megabytes, double budget_mb) {
  return failure("bake",
                 "%.0f probes of %u x %u texels take about %.3f MB, more than the budget of %g MB: fewer probes, "
                 "or smaller maps (--radiance-size)",
                 light_probe_count(settings), settings->radiance_size, settings->radiance_size, megabytes, budget_mb);
}

// Prints what was chosen, or refuses what was given.
static int check_budget(const olx_scene *scene, const olx_bake_settings *settings, double budget_mb) {
  double megabytes;
  if (expect_size(scene, settings, &megabytes) != OLX_OK) return library_failure("bake");
  if (megabytes > budget_mb) return refuse(settings, megabytes, budget_mb);
  if (is_quiet()) return EXIT_DONE;
  const char *uncounted = settings->relight ? ", and more for relighting," : "";
  fprintf(stderr, "octalux bake: %.0f probes of %u x %u texels, about %.3f MB%s of a budget of %g MB\n",
          light_probe_count(settings), settings->radiance_size, settings->radiance_size, megabytes, uncounted,
          budget_mb);
  return EXIT_DONE;
}

int fit_bake_budget(const olx_scene *scene, const command_line *line, double budget_mb, bake_options *given) {
  olx_bake_settings *settings = &given->settings;
  const bool sized = was_given(line, "--radiance-size");
  if (!given->probes && !was_given(line, "--grid")) {
    olx_result placed = place_probes(scene, sized ? budget_mb : 0.0, given);
    if (placed == OLX_OK && sized) placed = drop_probes(scene, budget_mb, settings);
    if (placed != OLX_OK) return report_placement(placed);
  }
  if (!sized && olx_bake_size_for_budget(scene, settings, budget_mb, &settings->radiance_size) != OLX_OK)
    return library_failure("bake");
  return check_budget(scene, settings, budget_mb);
}
