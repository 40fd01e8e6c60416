// Measures the time of a bake relative to Embree casting only the same rays from the probes.
#include "bake_options.h"
#include "bench_measure.h"
#include "options.h"
#include "report.h"
#include "scene_options.h"
#include "studies.h"

#include <octalux/bake.h>

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char NAME[] = BENCH_PROGRAM " speed";

typedef struct speed_bench {
  const char *scene_name;
  bake_options given;
  scene_options loading;
  bool progress, json;
} speed_bench;

static int report_speed(const speed_bench *bench, const olx_bake_settings *settings, const olx_bake_stats *stats) {
  const double probes = light_probe_count(settings);
  const double ratio = stats->embree_seconds > 0.0 ? stats->seconds / stats->embree_seconds : 0.0;
  if (bench->json) {
    cJSON *object = cJSON_CreateObject();
    add_text(object, "experiment", "speed");
    add_text(object, "scene", bench->scene_name);
    add_number(object, "probes", probes);
    add_number(object, "radiance_size", settings->radiance_size);
    add_number(object, "samples", settings->samples);
    add_number(object, "bounces", settings->bounces);
    add_number(object, "rays", (double)stats->rays);
    add_number(object, "primary_rays", (double)stats->primary_rays);
    add_number(object, "seconds", stats->seconds);
    add_number(object, "embree_seconds", stats->embree_seconds);
    add_number(object, "ratio", ratio);
    return print_json(NAME, object);
  }
  printf("%-24s %8s %8s %14s %10s %10s %8s\n", "scene", "probes", "texels", "rays", "bake s", "Embree s", "ratio");
  printf("%-24s %8.0f %8u %14" PRIu64 " %10.2f %10.2f %8.2f\n", bench->scene_name, probes, settings->radiance_size,
         stats->rays, stats->seconds, stats->embree_seconds, ratio);
  return EXIT_DONE;
}

static int bake_to(speed_bench *bench, const command_line *options, const olx_scene *scene, const char *path) {
  olx_bake_settings *settings = &bench->given.settings;
  if (resolve_bake_options(scene, options, &bench->given) != OLX_OK) return library_failure(NAME);
  settings->measure_embree = true;
  progress_line line;
  progress_begin(&line, NAME, bench->progress);
  const olx_progress progress = progress_of(&line);
  olx_bake_stats stats;
  const olx_result result = olx_bake(scene, settings, path, &progress, &stats);
  progress_end(&line);
  release_bake_settings(settings);
  if (result == OLX_ERROR_CANCELLED) return failure(NAME, "interrupted");
  if (result != OLX_OK) return library_failure(NAME);
  return report_speed(bench, settings, &stats);
}

// Measures the time of a bake relative to Embree casting only the same rays from the probes.
static int run_speed(speed_bench *bench, const command_line *options) {
  olx_scene *scene = NULL;
  int code = load_scene(NAME, bench->scene_name, &bench->loading, &scene);
  if (code != EXIT_DONE) return code;
  bench_folder folder;
  char path[sizeof folder.path + 16];
  if (!bench_folder_make(&folder)) {
    code = failure(NAME, "%s: cannot create a temporary folder", folder.path);
  } else {
    snprintf(path, sizeof path, "%s/field.olx", folder.path);
    code = bake_to(bench, options, scene, path);
    unlink(path);
    bench_folder_remove(&folder);
  }
  olx_scene_free(scene);
  return code;
}

int study_bake_speed(int argc, char **argv) {
  speed_bench bench = {.scene_name = "builtin:cornell", .given = bake_options_begin()};
  command_line line = {
      .name = NAME,
      .summary = "How long a bake (of builtin:cornell, or SCENE) takes against Embree casting the same rays from\n"
                 "its probes and nothing else, in one run.",
      .arguments = {"[SCENE]"},
      .tables = {{bake_basic_options, &bench.given},
                 {threads_option, &bench.given.settings.threads},
                 {bake_quality_options, &bench.given, "Quality"},
                 {bake_research_options, &bench.given, RESEARCH},
                 {scene_loading_options, &bench.loading},
                 {progress_option, &bench.progress},
                 {json_option, &bench.json}}};
  int code;
  if (!parse_options(&line, argc, argv, &code)) return code;
  if (line.given[0]) bench.scene_name = line.given[0];
  return run_speed(&bench, &line);
}
