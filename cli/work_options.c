// Decides where a bake stores its results, and prints a line for each unit on request.
#include "work_options.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

const option work_folder_options[] = {
    {"--work", OPTION_TEXT, offsetof(work_options, folder), "DIR",
     "keep results in this folder, and resume from it; default for long bakes: FILE.olx.work"},
    {"--no-work", OPTION_FLAG, offsetof(work_options, none), NULL, "keep no results: an interrupted bake begins anew"},
    {"--fresh", OPTION_FLAG, offsetof(work_options, fresh), NULL,
     "discard the results in the work folder, and begin anew"},
    {"--keep-work", OPTION_FLAG, offsetof(work_options, keep), NULL,
     "keep the work folder after the field is written, and reuse its results that an edited scene leaves valid"},
    {"--explain", OPTION_FLAG, offsetof(work_options, explain), NULL,
     "print how much of each stage was reused from the work folder, and why the rest was not"},
    {"--work-limit", OPTION_REAL, offsetof(work_options, limit), "GIB",
     "the most space that the work folder takes; default: no limit"},
    {"--part", OPTION_TEXT, offsetof(work_options, part), "I/N",
     "compute the I-th of N shares of the work; after exit code 75 call it again"},
    {0}};

// Rays from probes, about one minute of one processor, beyond which a bake is worth resuming.
#define LONG_BAKE_RAYS UINT64_C(50000000)

static bool parse_number(const char *text, char end, uint32_t *number, const char **next) {
  char *stop;
  if (*text < '0' || *text > '9') return false;
  const unsigned long value = strtoul(text, &stop, 10);
  *number = (uint32_t)value;
  *next = stop + (*stop ? 1 : 0);
  return *stop == end && value > 0 && value <= 1000000;
}

static bool parse_part(const char *text, olx_bake_work *work) {
  return parse_number(text, '/', &work->part, &text) && parse_number(text, 0, &work->parts, &text) &&
         work->part <= work->parts;
}

static void count_unit(void *user, const olx_bake_unit *unit) {
  work_line *line = user;
  count_work_unit(&line->report, unit);
  if (!line->json) return;
  fprintf(stderr,
          "{\"stage\":\"%s\",\"round\":%u,\"unit\":%u,\"count\":%u,\"found\":%s,\"seconds\":%.6f,"
          "\"bytes\":%" PRIu64 ",\"why\":\"%s\"}\n",
          unit->stage, unit->round, unit->unit, unit->count, unit->found ? "true" : "false", unit->seconds, unit->bytes,
          unit->why);
}

// Returns whether a folder that only its owner can access can be created there: some file systems do not support this.
static bool can_be_private(const char *folder) {
  struct stat status;
  if (mkdir(folder, 0700) != 0) return false;
  const bool private = stat(folder, &status) == 0 && (status.st_mode & 077) == 0;
  rmdir(folder);
  return private;
}

// Returns whether a bake uses a work folder: when it is long, or its units are to be told of, and it can be kept, or
// when its folder already exists.
static bool wants_folder(const olx_scene *scene, const olx_bake_settings *settings, const char *output,
                         const work_line *line) {
  olx_bake_sizes sizes;
  if (access(line->folder, F_OK) == 0) return true;
  if (olx_bake_measure(scene, settings, output, &sizes) != OLX_OK) return false;
  if (sizes.rays <= LONG_BAKE_RAYS && !line->json) return false;
  return sizes.work_bytes > 0 && can_be_private(line->folder);
}

static int check_given(const work_options *given, const olx_bake_settings *settings, const work_line *line) {
  if (given->none &&
      (given->folder || given->part || given->fresh || given->keep || given->explain || given->limit > 0.0f)) {
    return usage_error("bake", "--no-work excludes whatever else is said of the work folder");
  }
  if (given->none && line->json)
    return usage_error("bake", "--progress=json tells of units of a work folder, which --no-work excludes");
  if (!given->part) return EXIT_DONE;
  if (!given->folder) return usage_error("bake", "--part needs --work DIR, which all parts share");
  if (given->fresh)
    return usage_error("bake", "--fresh and --part exclude each other: a part must not forget what others made");
  return settings->work.parts ? EXIT_DONE
                              : usage_error("bake", "--part: '%s' is not I/N, from 1/N to N/N", given->part);
}

int check_work_options(const work_options *given, bool dry_run) {
  if (!given->driven) return EXIT_DONE;
  if (given->part) return usage_error("bake", "--part: the ranks are the parts");
  if (given->none) return usage_error("bake", "--no-work: the ranks share a work folder");
  return dry_run ? usage_error("bake", "--dry-run: octalux bake does that, with the same options") : EXIT_DONE;
}

int resolve_work_options(const olx_scene *scene, const work_options *given, const char *output,
                         olx_bake_settings *settings, work_line *line) {
  olx_bake_work *work = &settings->work;
  if (given->part && !parse_part(given->part, work)) work->parts = 0;
  const int code = check_given(given, settings, line);
  if (code != EXIT_DONE || given->none) return code;
  const int length = snprintf(line->folder, sizeof line->folder, "%s%s", given->folder ? given->folder : output,
                              given->folder ? "" : ".work");
  if (length >= (int)sizeof line->folder) return failure("bake", "the name of the work folder is too long");
  const bool asked =
      given->driven || given->folder || given->keep || given->fresh || given->explain || given->limit > 0.0f;
  if (!asked && !wants_folder(scene, settings, output, line)) return EXIT_DONE;
  work->folder = line->folder;
  work->fresh = given->fresh;
  work->keep = given->keep;
  work->limit_bytes = (uint64_t)((double)given->limit * 0x1p30);
  work->done = count_unit;
  work->user = line;
  return EXIT_DONE;
}
