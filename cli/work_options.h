// The options of `bake` for storing results while it works, and its reports of units.
#ifndef OCTALUX_CLI_WORK_OPTIONS_H
#define OCTALUX_CLI_WORK_OPTIONS_H

#include "options.h"

#include <octalux/bake.h>

typedef struct work_options {
  const char *folder, *part; // NULL when not given
  float limit;               // GiB; 0 when not given
  bool none, fresh, keep;
} work_options;

// Rows of an option table that fill `w`.
#define WORK_OPTION_ROWS(w)                                                                                             \
  {"--work",                                                                                                            \
   OPTION_TEXT,                                                                                                         \
   &(w).folder,                                                                                                         \
   "DIR",                                                                                                               \
   "keep results there, and go on from what is there; default for long bakes: FILE.olx.work",                           \
   0,                                                                                                                   \
   0},                                                                                                                  \
      {"--no-work", OPTION_FLAG, &(w).none, NULL, "keep nothing: what is interrupted begins again", 0, 0},              \
      {"--fresh", OPTION_FLAG, &(w).fresh, NULL, "forget what the work folder holds, and begin again", 0, 0},           \
      {"--keep-work", OPTION_FLAG, &(w).keep, NULL, "leave the work folder when the field is written", 0, 0},           \
      {"--work-limit", OPTION_REAL, &(w).limit, "GIB", "the most that the work folder takes; default: no bound", 0, 0}, \
  {                                                                                                                     \
    "--part", OPTION_TEXT, &(w).part, "I/N", "make the I-th of N shares of the work; exit code 75: call it again", 0,   \
        0                                                                                                               \
  }

// Counts of the units of a bake, for its report.
typedef struct work_line {
  bool json; // print a line of JSON for each unit on standard error
  uint32_t made, found;
  char folder[4096];
} work_line;

// Sets settings->work from the options; `output` is NULL for a part. Returns EXIT_DONE, or the exit code after a line
// with the reason. `line` must live as long as the settings.
int resolve_work_options(const olx_scene *scene, const work_options *given, const char *output,
                         olx_bake_settings *settings, work_line *line);

#endif
