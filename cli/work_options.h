// The options of `bake` for storing results while it works, and its reports of units.
#ifndef OCTALUX_CLI_WORK_OPTIONS_H
#define OCTALUX_CLI_WORK_OPTIONS_H

#include "options.h"
#include "work_report.h"

#include <octalux/bake.h>

typedef struct work_options {
  const char *folder, *part; // NULL when not given
  float limit;               // GiB; 0 when not given
  bool none, fresh, keep, explain;
  bool driven; // a bake_driver.h runs all parts; not an option
} work_options;

// Options that fill a work_options.
extern const option work_folder_options[];

// Counts of the units of a bake, for its report.
typedef struct work_line {
  bool json; // print a line of JSON for each unit on standard error
  work_report report;
  char folder[4096];
} work_line;

// Checks what is known before the scene is loaded. Returns EXIT_DONE, or the exit code after a line with the reason.
int check_work_options(const work_options *given, bool dry_run);

// Sets settings->work from the options; `output` is NULL for a part. Returns EXIT_DONE, or the exit code after a line
// with the reason. `line` must live as long as the settings.
int resolve_work_options(const olx_scene *scene, const work_options *given, const char *output,
                         olx_bake_settings *settings, work_line *line);

#endif
