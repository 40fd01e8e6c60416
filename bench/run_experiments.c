// Runs the experiments that the command line names, prints their findings, and writes them as JSON and
// as a report.
#include "experiment.h"
#include "html_report.h"
#include "options.h"
#include "report.h"
#include "studies.h"
#include "wang/wang_study.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static const experiment *find(const char *name) {
  for (uint32_t i = 0; i < experiment_count; ++i) {
    if (strcmp(experiments[i].name, name) == 0) return &experiments[i];
  }
  return NULL;
}

static int unknown(const char *name) {
  char *names = NULL;
  size_t size_bytes;
  FILE *out = open_memstream(&names, &size_bytes);
  if (!out) return failure(BENCH_PROGRAM, "out of memory");
  for (uint32_t i = 0; i < experiment_count; ++i) fprintf(out, ", %s", experiments[i].name);
  for (uint32_t i = 0; i < study_count; ++i) fprintf(out, ", %s", studies[i].name);
  if (fclose(out) != 0) return failure(BENCH_PROGRAM, "out of memory");
  const int code = usage_error(BENCH_PROGRAM, "unknown experiment '%s': there are all%s", name, names);
  free(names);
  return code;
}

static bool has_scene(const experiment *e, const char *name, size_t length) {
  for (uint32_t i = 0; e->scene(i); ++i) {
    if (strlen(e->scene(i)) == length && strncmp(e->scene(i), name, length) == 0) return true;
  }
  return false;
}

static int unknown_scene(const experiment *e, const char *name, size_t length) {
  char known[2048];
  size_t used = 0;
  for (uint32_t i = 0; e->scene(i) && used < sizeof known; ++i)
    used += (size_t)snprintf(known + used, sizeof known - used, "%s%s", i ? ", " : "", e->scene(i));
  return usage_error(BENCH_PROGRAM, "unknown scene '%.*s': %s has %s", (int)length, name, e->name, known);
}

// Whether --only names scenes that the experiment has; when not, a line says which those are. `e` is NULL for all of them.
static bool check_scenes(const experiment *e, const char *names, int *code) {
  if (!e || !e->scene) {
    *code = usage_error(BENCH_PROGRAM, "--only goes with an experiment that takes scene after scene: surfaces");
    return false;
  }
  for (const char *name = names, *comma; name; name = comma ? comma + 1 : NULL) {
    comma = strchr(name, ',');
    const size_t length = comma ? (size_t)(comma - name) : strlen(name);
    if (has_scene(e, name, length)) continue;
    *code = unknown_scene(e, name, length);
    return false;
  }
  return true;
}

static void put_summary(FILE *out) {
  fputs("Measure an experiment of the papers, or all of them:\n", out);
  for (uint32_t i = 0; i < experiment_count; ++i)
    fprintf(out, "  %-21s %s\n", experiments[i].name, experiments[i].what);
  fprintf(out, "  %-21s %s\n", "all", "all of the above");
  fputs("Studies, which take no options below but their own (NAME --help), or these arguments:", out);
  for (uint32_t i = 0; i < study_count; ++i) {
    fprintf(out, "\n  %-21s %s", studies[i].name, studies[i].what);
    if (studies[i].arguments) fprintf(out, "\n  %-21s   %s", "", studies[i].arguments);
  }
}

// The command line that measures this experiment alone.
static void make_command(const experiment *e, const bench_options *o, char command[256]) {
  int used = snprintf(command, 256, "octalux-bench %s%s", e->name, o->quick ? " --quick" : "");
  if (o->size[0]) used += snprintf(command + used, 256 - (size_t)used, " --size %ux%u", o->size[0], o->size[1]);
  if (o->spp) used += snprintf(command + used, 256 - (size_t)used, " --spp %u", o->spp);
  if (o->only) snprintf(command + used, 256 - (size_t)used, " --only %s", o->only);
}

static cJSON *begin_section(cJSON *report, const experiment *e, const char *command) {
  if (!report) return NULL;
  cJSON *section = html_report_section(report, e->what, e->note, command);
  add_text(section, "name", e->name);
  add_text(section, "source", e->source);
  return section;
}

static void tell_findings(const bench *b, const experiment *e, const char *command, cJSON *list) {
  if (b->options->json) {
    cJSON *object = cJSON_CreateObject();
    cJSON_AddItemToArray(list, object);
    add_text(object, "experiment", e->name);
    add_text(object, "source", e->source);
    add_text(object, "command", command);
    findings_add_json(&b->found, object);
    return;
  }
  printf("%s: %s (%s; %.0f s, %.0f s of processors)\n", e->name, e->what, e->source, b->found.seconds,
         b->found.processor_seconds);
  findings_print(&b->found);
  putchar('\n');
}

static olx_result run_one(bench *b, const experiment *e, cJSON *report, cJSON *list) {
  char command[256];
  make_command(e, b->options, command);
  cJSON *section = begin_section(report, e, command);
  const olx_result result = bench_run(b, e, section);
  if (result == OLX_OK) {
    tell_findings(b, e, command, list);
    if (section) findings_add_report(&b->found, section);
  }
  findings_free(&b->found);
  // An experiment that has not ended is not shown.
  if (result != OLX_OK && section) {
    cJSON_Delete(cJSON_DetachItemViaPointer(cJSON_GetObjectItem(report, "sections"), section));
  }
  return result;
}

static int finish_json(const char *command, cJSON *list, bool all) {
  if (!all) {
    cJSON *only = cJSON_DetachItemFromArray(list, 0);
    cJSON_Delete(list);
    add_text(only, "version", olx_version());
    return print_json(BENCH_PROGRAM, only);
  }
  cJSON *object = cJSON_CreateObject();
  add_text(object, "command", command);
  add_text(object, "version", olx_version());
  cJSON_AddItemToObject(object, "experiments", list);
  return print_json(BENCH_PROGRAM, object);
}

// Experiments that have ended are kept when a later one fails or is interrupted. Takes report and list.
static int write_findings(const bench_options *o, bool all, const char *command, uint32_t ended, cJSON *report,
                          cJSON *list) {
  int code = EXIT_DONE;
  if (report && ended) {
    char path[4096];
    snprintf(path, sizeof path, "%s/index.html", o->report);
    code = html_report_write(BENCH_PROGRAM, report, path);
  } else {
    cJSON_Delete(report);
  }
  if (code == EXIT_DONE && o->json && ended) return finish_json(command, list, all);
  cJSON_Delete(list);
  return code;
}

static int run_named(const bench_options *o, const experiment *only, const char *command) {
  progress_line line;
  progress_begin(&line, BENCH_PROGRAM, false);
  bench b;
  if (!bench_open(&b, o, &line)) return failure(BENCH_PROGRAM, "%s: cannot create a temporary folder", b.folder.path);
  cJSON *list = cJSON_CreateArray();
  cJSON *report = o->report ? html_report_begin(only ? only->name : "The experiments, reproduced", command) : NULL;
  olx_result result = OLX_OK;
  uint32_t ended = 0;
  for (uint32_t i = 0; i < experiment_count && result == OLX_OK; ++i) {
    if (only && only != &experiments[i]) continue;
    result = run_one(&b, &experiments[i], report, list);
    ended += result == OLX_OK;
  }
  progress_end(&line);
  wang_study_free(b.wang);
  bench_close(&b);
  int code = result == OLX_OK                ? EXIT_DONE
             : result == OLX_ERROR_CANCELLED ? failure(BENCH_PROGRAM, "interrupted")
                                             : library_failure(BENCH_PROGRAM);
  const int written = write_findings(o, !only, command, ended, report, list);
  return code == EXIT_DONE ? written : code;
}

// A folder that is there, or that can be made.
static bool ready_folder(const char *path, const char *file) {
  char name[4096];
  if (!path) return true;
  mkdir(path, 0777);
  snprintf(name, sizeof name, "%s/%s", path, file);
  return check_output(BENCH_PROGRAM, name, true);
}

int run_experiments(int argc, char **argv) {
  bench_options o = {.folder = "scenes"};
  const option options[] = {
      {"--quick", OPTION_FLAG, &o.quick, NULL, "built-in scenes alone, small and rough", 0, 0},
      {"--report", OPTION_TEXT, &o.report, "FOLDER", "write index.html there: tables, plots, and pictures to compare",
       0, 0},
      {"--images", OPTION_TEXT, &o.images, "FOLDER", "write the pictures that are compared there, as .png", 0, 0},
      {"--scenes", OPTION_TEXT, &o.folder, "FOLDER", "where descriptions of scenes are; default scenes", 0, 0},
      {"--only", OPTION_TEXT, &o.only, "NAME,...", "surfaces: these scenes alone", 0, 0},
      {"--size", OPTION_SIZE, o.size, "320x240", "of all pictures; default: each experiment's own", 16, 16384},
      {"--spp", OPTION_COUNT, &o.spp, "N", "of each of two references, path traced; default: each experiment's own", 1,
       1u << 20},
      {"--threads", OPTION_COUNT, &o.threads, "N", "default 0: every processor; times are of one all the same", 0,
       4096},
      {"--progress", OPTION_FLAG, &o.progress, NULL, "tell progress even when nobody watches", 0, 0},
      {"--json", OPTION_FLAG, &o.json, NULL, "print one JSON object", 0, 0},
  };
  char *summary = NULL;
  size_t size_bytes;
  FILE *out = open_memstream(&summary, &size_bytes);
  if (!out) return failure(BENCH_PROGRAM, "out of memory");
  put_summary(out);
  if (fclose(out) != 0) return failure(BENCH_PROGRAM, "out of memory");
  command_line line = {.name = BENCH_PROGRAM,
                       .summary = summary,
                       .arguments = {"EXPERIMENT"},
                       .options = options,
                       .option_count = sizeof options / sizeof options[0]};
  int code;
  const bool go_on = parse_options(&line, argc, argv, &code);
  free(summary);
  if (!go_on) return code;
  const experiment *only = find(line.given[0]);
  if (!only && strcmp(line.given[0], "all") != 0) return unknown(line.given[0]);
  o.all = !only;
  if (o.only && !check_scenes(only, o.only, &code)) return code;
  if (!ready_folder(o.report, "index.html") || !ready_folder(o.images, "image.png")) return EXIT_FAILED;
  char *command = command_text(argc, argv);
  code = command ? run_named(&o, only, command) : failure(BENCH_PROGRAM, "out of memory");
  free(command);
  return code;
}
