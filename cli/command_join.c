// Joins what the parts of a bake have made into one field.
#include "commands.h"
#include "options.h"
#include "report.h"

#include <octalux/bake.h>

#include <stdio.h>

typedef struct joining {
  const char *output;
  bool keep, progress, json;
} joining;

static int print_join(const char *path, const olx_bake_stats *stats, bool json) {
  if (!json) {
    printf("%s: %s, joined in %.2f s\n", path, text_of_bytes(stats->file_bytes).text,
           stats->seconds + stats->write_seconds);
    return EXIT_DONE;
  }
  cJSON *object = cJSON_CreateObject();
  add_number(object, "file_bytes", (double)stats->file_bytes);
  add_number(object, "seconds", stats->seconds);
  add_number(object, "write_seconds", stats->write_seconds);
  return print_json("join", object);
}

static int join(const char *folder, const joining *o) {
  progress_line line;
  progress_begin(&line, "join", o->progress);
  const olx_progress progress = progress_of(&line);
  olx_bake_stats stats;
  const olx_result result = olx_bake_join(folder, o->output, o->keep, &progress, &stats);
  progress_end(&line);
  if (result == OLX_ERROR_CANCELLED) return failure("join", "%s: interrupted, nothing written", o->output);
  if (result == OLX_OK) return print_join(o->output, &stats, o->json);
  const int code = library_failure("join");
  return result == OLX_ERROR_INCOMPLETE ? EXIT_AGAIN : code;
}

static const option join_options[] = {
    {"-o", OPTION_TEXT, offsetof(joining, output), "FILE.olx", "the field to write", 1},
    {"--keep-work", OPTION_FLAG, offsetof(joining, keep), NULL, "leave the work folder when the field is written"},
    {0}};

int command_join(int argc, char **argv) {
  joining o = {0};
  command_line line = {.name = "join",
                       .summary = "Check and join what all parts of a bake (bake --work DIR --part I/N) made.",
                       .example = "octalux join room.work -o room.olx",
                       .arguments = {"DIR"},
                       .tables = {{join_options, &o}, {progress_option, &o.progress}, {json_option, &o.json}}};
  int code;
  if (!parse_options(&line, argc, argv, &code)) return code;
  if (!check_output("join", o.output, false)) return EXIT_FAILED;
  return join(line.given[0], &o);
}
