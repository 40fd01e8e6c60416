// Runs the experiments that the command line names, prints their findings, and writes them as JSON and
// as a report.
#include "experiment.h"
#include "html_report.h"
#include "options.h"
#include "report.h"
#include "studies.h"

#include <octalux/limits.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static const experiment *find(const char *name, size_t length) {
  for (uint32_t i = 0; i < experiment_count; ++i) {
    if (strlen(experiments[i].name) == length && strncmp(experiments[i].name, name, length) == 0)
      return &experiments[i];
  }
  return NULL;
}

// Returns whether the names on the command line, which are "all" or separated by commas, include the experiment.
static bool is_named(const char *names, const experiment *e) {
  return strcmp(names, "all") == 0 ? !e->alone : bench_listed(names, e->name);
}

static int unknown(const char *name, size_t length) {
  char *names = NULL;
  size_t size_bytes;
  FILE *out = open_memstream(&names, &size_bytes);
  if (!out) return failure(BENCH_PROGRAM, "out of memory");
  for (uint32_t i = 0; i < experiment_count; ++i) fprintf(out, ", %s", experiments[i].name);
  for (uint32_t i = 0; i < study_count; ++i) fprintf(out, ", %s", studies[i].name);
  if (fclose(out) != 0) return failure(BENCH_PROGRAM, "out of memory");
  const int code = usage_error(BENCH_PROGRAM, "unknown experiment '%.*s': there are all%s", (int)length, name, names);
  free(names);
  return code;
}

// Takes the first name off a text that separates names by commas. Returns NULL when none is left.
static const char *take_name(const char **rest, size_t *length) {
  const char *name = *rest, *comma = name ? strchr(name, ',') : NULL;
  if (name) *length = comma ? (size_t)(comma - name) : strlen(name);
  *rest = comma ? comma + 1 : NULL;
  return name;
}

// Checks that there are experiments of all these names.
static bool check_names(const char *names, int *code) {
  if (strcmp(names, "all") == 0) return true;
  size_t length;
  for (const char *rest = names, *name; (name = take_name(&rest, &length));) {
    if (find(name, length)) continue;
    *code = unknown(name, length);
    return false;
  }
  return true;
}

// Checks that an experiment has all of these names in a list of its own, of scenes or of probes; otherwise lists them.
static bool check_listed(const experiment *e, const char *(*listed)(uint32_t), const char *what, const char *names,
                         int *code) {
  char known[2048];
  size_t used = 0, length;
  for (uint32_t i = 0; listed(i) && used < sizeof known; ++i)
    used += (size_t)snprintf(known + used, sizeof known - used, "%s%s", i ? ", " : "", listed(i));
  for (const char *rest = names, *name; (name = take_name(&rest, &length));) {
    uint32_t i = 0;
    while (listed(i) && (strlen(listed(i)) != length || strncmp(listed(i), name, length) != 0)) ++i;
    if (listed(i)) continue;
    *code = usage_error(BENCH_PROGRAM, "unknown %s '%.*s': %s has %s", what, (int)length, name, e->name, known);
    return false;
  }
  return true;
}

static bool takes_scenes(const experiment *e) { return e->scene; }
static bool takes_sizes(const experiment *e) { return e->takes & TAKES_SIZES; }
static bool takes_sets(const experiment *e) { return e->takes & TAKES_SETS; }
static bool takes_short(const experiment *e) { return e->takes & TAKES_SHORT; }

// Reports which experiments take the option.
static int misplaced(const char *name, bool (*takes)(const experiment *)) {
  char known[512];
  size_t used = 0;
  known[0] = 0;
  for (uint32_t i = 0; i < experiment_count && used < sizeof known; ++i) {
    if (!takes(&experiments[i])) continue;
    used += (size_t)snprintf(known + used, sizeof known - used, "%s%s", used ? ", " : "", experiments[i].name);
  }
  return usage_error(BENCH_PROGRAM, "%s goes with %s", name, known);
}

// Checks that --only names scenes of the experiment. `e` is NULL for several experiments.
static bool check_scenes(const experiment *e, const char *names, int *code) {
  if (e && e->scene) return check_listed(e, e->scene, "scene", names, code);
  *code = misplaced("--only", takes_scenes);
  return false;
}

// Checks that the experiment takes the given options; otherwise reports which one does. `e` is NULL for several
// experiments.
static bool check_options(const experiment *e, const bench_options *o, int *code) {
  const struct {
    const char *name;
    bool given;
    bool (*takes)(const experiment *);
  } options[] = {{"--texels", o->texels, takes_sizes},
                 {"--field-spp", o->field_spp, takes_sizes},
                 {"--rounds", o->rounds, takes_sizes},
                 {"--probes", o->sets, takes_sets},
                 {"--short", o->brief, takes_short}};
  for (size_t i = 0; i < sizeof options / sizeof *options; ++i) {
    if (!options[i].given || (e && options[i].takes(e))) continue;
    *code = misplaced(options[i].name, options[i].takes);
    return false;
  }
  if (e && e->set && o->sets && !check_listed(e, e->set, "probes", o->sets, code)) return false;
  return !o->only || check_scenes(e, o->only, code);
}

static void list_experiments(FILE *out, bool alone) {
  for (uint32_t i = 0; i < experiment_count; ++i) {
    if (experiments[i].alone == alone) fprintf(out, "  %-21s %s\n", experiments[i].name, experiments[i].what);
  }
}

static void put_summary(FILE *out) {
  fputs("Measure experiments of the papers, named one by one with commas between them, or all:\n", out);
  list_experiments(out, false);
  fprintf(out, "  %-21s %s\n", "all", "all of the above");
  fputs("Experiments that take hours and are no part of all:\n", out);
  list_experiments(out, true);
  fputs("Studies, which take no options below but their own (NAME --help), or these arguments:", out);
  for (uint32_t i = 0; i < study_count; ++i) {
    fprintf(out, "\n  %-21s %s", studies[i].name, studies[i].what);
    if (studies[i].arguments) fprintf(out, "\n  %-21s   %s", "", studies[i].arguments);
  }
}

// Returns the command line that measures this experiment alone, which the caller frees; NULL when memory runs out.
static char *make_command(const experiment *e, const bench_options *o) {
  char *command = NULL;
  size_t size_bytes;
  FILE *out = open_memstream(&command, &size_bytes);
  if (!out) return NULL;
  fprintf(out, BENCH_PROGRAM " %s%s", e->name, o->quick ? " --quick" : "");
  if (o->size[0]) fprintf(out, " --size %ux%u", o->size[0], o->size[1]);
  if (o->spp) fprintf(out, " --spp %u", o->spp);
  if (o->texels) fprintf(out, " --texels %u", o->texels);
  if (o->field_spp) fprintf(out, " --field-spp %u", o->field_spp);
  if (o->rounds) fprintf(out, " --rounds %u", o->rounds);
  if (o->sets) fprintf(out, " --probes %s", o->sets);
  if (o->brief) fputs(" --short", out);
  if (o->only) fprintf(out, " --only %s", o->only);
  return fclose(out) == 0 ? command : NULL;
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
  char *command = make_command(e, b->options);
  if (!command) return OLX_ERROR_MEMORY;
  cJSON *section = begin_section(report, e, command);
  const olx_result result = bench_run(b, e, section);
  if (result == OLX_OK) {
    tell_findings(b, e, command, list);
    if (section) findings_add_report(&b->found, section);
  }
  findings_free(&b->found);
  free(command);
  // Unfinished experiments are not shown.
  if (result != OLX_OK && section) {
    cJSON_Delete(cJSON_DetachItemViaPointer(cJSON_GetObjectItem(report, "sections"), section));
  }
  return result;
}

static int finish_json(const char *command, cJSON *list, bool several) {
  if (!several) {
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

// Writes the findings. Finished experiments are kept when a later one fails or is interrupted. Takes ownership of
// report and list.
static int write_findings(const bench_options *o, const char *command, uint32_t ended, cJSON *report, cJSON *list) {
  int code = EXIT_DONE;
  if (report && ended) {
    char path[4096];
    snprintf(path, sizeof path, "%s/index.html", o->report);
    code = html_report_write(BENCH_PROGRAM, report, path);
  } else {
    cJSON_Delete(report);
  }
  if (code == EXIT_DONE && o->json && ended) return finish_json(command, list, o->several);
  cJSON_Delete(list);
  return code;
}

static int run_named(const bench_options *o, const char *names, const char *command) {
  progress_line line;
  progress_begin(&line, BENCH_PROGRAM, false);
  bench b;
  if (!bench_open(&b, o, &line)) return failure(BENCH_PROGRAM, "%s: cannot create a temporary folder", b.folder.path);
  cJSON *list = cJSON_CreateArray();
  cJSON *report = o->report ? html_report_begin(o->several ? "The experiments, reproduced" : names, command) : NULL;
  olx_result result = OLX_OK;
  uint32_t ended = 0;
  for (uint32_t i = 0; i < experiment_count && result == OLX_OK; ++i) {
    if (!is_named(names, &experiments[i])) continue;
    result = run_one(&b, &experiments[i], report, list);
    ended += result == OLX_OK;
  }
  progress_end(&line);
  bench_close(&b);
  int code = result == OLX_OK                ? EXIT_DONE
             : result == OLX_ERROR_CANCELLED ? failure(BENCH_PROGRAM, "interrupted")
                                             : library_failure(BENCH_PROGRAM);
  const int written = write_findings(o, command, ended, report, list);
  return code == EXIT_DONE ? written : code;
}

// Checks that a folder exists or can be created.
static bool ready_folder(const char *path, const char *file) {
  char name[4096];
  if (!path) return true;
  mkdir(path, 0777);
  snprintf(name, sizeof name, "%s/%s", path, file);
  return check_output(BENCH_PROGRAM, name, true);
}

static const option options[] = {
    {"--quick", OPTION_FLAG, offsetof(bench_options, quick), NULL, "built-in scenes alone, small and rough"},
    {"--report", OPTION_TEXT, offsetof(bench_options, report), "FOLDER",
     "write index.html there: tables, plots, and pictures to compare"},
    {"--images", OPTION_TEXT, offsetof(bench_options, images), "FOLDER",
     "write the pictures that are compared there, as .png"},
    {"--scenes", OPTION_TEXT, offsetof(bench_options, folder), "FOLDER",
     "where descriptions of scenes are; default scenes"},
    {"--only", OPTION_TEXT, offsetof(bench_options, only), "NAME,...", "surfaces, wang...: these scenes alone"},
    {"--size", OPTION_SIZE, offsetof(bench_options, size), "320x240", "of all pictures; default: each experiment's own",
     16, OLX_PICTURE_SIZE_MOST},
    {"--spp", OPTION_COUNT, offsetof(bench_options, spp), "N",
     "of each of two references, path traced; default: each experiment's own", 1, OLX_PICTURE_SPP_MOST},
    {"--texels", OPTION_POWER_OF_TWO, offsetof(bench_options, texels), "N",
     "wang...: along a map of light; default: the experiment's own", 16, 1024},
    {"--field-spp", OPTION_COUNT, offsetof(bench_options, field_spp), "N",
     "wang...: of each of two pictures from a field", 1, OLX_PICTURE_LOBE_SAMPLES_MOST},
    {"--rounds", OPTION_COUNT, offsetof(bench_options, rounds), "N", "wang...: in which each row is timed once", 1,
     1000},
    {"--probes", OPTION_TEXT, offsetof(bench_options, sets), "4x2x4,A.json,B.json@1024",
     "wang-probes: only these sets, against the first; surfaces: placed or grid"},
    {"--short", OPTION_FLAG, offsetof(bench_options, brief), NULL, "wang: without the series of sets in appendix A"},
    {"--threads", OPTION_COUNT, offsetof(bench_options, threads), "N",
     "default 0: every processor; times are of one all the same", 0, 4096},
    {0}};

int run_experiments(int argc, char **argv) {
  bench_options o = {.folder = "scenes"};
  char *summary = NULL;
  size_t size_bytes;
  FILE *out = open_memstream(&summary, &size_bytes);
  if (!out) return failure(BENCH_PROGRAM, "out of memory");
  put_summary(out);
  if (fclose(out) != 0) return failure(BENCH_PROGRAM, "out of memory");
  command_line line = {.name = BENCH_PROGRAM,
                       .summary = summary,
                       .arguments = {"EXPERIMENT,..."},
                       .tables = {{options, &o}, {progress_option, &o.progress}, {json_option, &o.json}}};
  int code;
  const bool go_on = parse_options(&line, argc, argv, &code);
  free(summary);
  if (!go_on) return code;
  const char *names = line.given[0];
  if (!check_names(names, &code)) return code;
  const experiment *only = find(names, strlen(names));
  o.several = !only;
  if (!check_options(only, &o, &code)) return code;
  if (!ready_folder(o.report, "index.html") || !ready_folder(o.images, "image.png")) return EXIT_FAILED;
  char *command = command_text(argc, argv);
  code = command ? run_named(&o, names, command) : failure(BENCH_PROGRAM, "out of memory");
  free(command);
  return code;
}
