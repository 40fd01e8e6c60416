// octalux-bench-gpu: measures each pass on a Vulkan device in milliseconds, beside the paper's times. It needs only a
// Vulkan loader.
#include "bench_compile.h"
#include "bench_report.h"

#include "options.h"

#include <octalux/limits.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char NAME[] = "octalux-bench-gpu";

enum { MAX_ROWS = 16, PATH_BYTES = 4096 };

typedef struct arguments {
  const char *data, *scene, *field, *rows, *camera;
  uint32_t size[2], frames, device, tracer, select, hits, ray_spacing;
  float bandwidth;
  bool json, quick, compare, list, validate, compile;
} arguments;

// Selects the rows that the command line names; false when one is unknown.
static bool choose_rows(const char *names, const bench_row **rows, uint32_t *count) {
  *count = 0;
  for (uint32_t i = 0; !names && bench_row_at(i); i++) rows[(*count)++] = bench_row_at(i);
  while (names && *names) {
    const size_t length = strcspn(names, ",");
    const bench_row *found = NULL;
    for (uint32_t i = 0; bench_row_at(i) && !found; i++) {
      const bench_row *row = bench_row_at(i);
      if (strlen(row->name) == length && strncmp(row->name, names, length) == 0) found = row;
    }
    if (!found || *count == MAX_ROWS) {
      usage_error(NAME, "--rows: there is no row '%.*s' (see %s --help)", (int)length, names, NAME);
      return false;
    }
    rows[(*count)++] = found;
    names += length + (names[length] == ',');
  }
  return true;
}

static bool check_arguments(const arguments *a) {
  const char *problem = NULL;
  if (a->list) return true;
  if (a->compile) {
    if (a->field && !a->scene && !a->data) return true;
    usage_error(NAME, "--compile goes with --field FILE.olx");
    return false;
  }
  if (!a->scene != !a->field) problem = "--scene and --field go together";
  else if (!a->scene == !a->data) problem = "either --data DIR, or --scene FILE.olxs and --field FILE.olx";
  else if (a->scene && a->rows) problem = "--rows chooses among those of --data";
  if (problem) usage_error(NAME, "%s", problem);
  return !problem;
}

static void run_rows(gpu_device *device, const arguments *a, const bench_settings *settings, const bench_row **rows,
                     uint32_t count, bench_result *results) {
  for (uint32_t i = 0; i < count; i++) {
    char scene[PATH_BYTES], field[PATH_BYTES];
    if (a->scene) {
      snprintf(scene, sizeof scene, "%s", a->scene);
      snprintf(field, sizeof field, "%s", a->field);
    } else {
      snprintf(scene, sizeof scene, "%s/%s.olxs", a->data, rows[i]->scene);
      snprintf(field, sizeof field, "%s/%s.olx", a->data, rows[i]->field);
    }
    fprintf(stderr, "%s: %s ...\n", NAME, rows[i]->name);
    bench_run(device, scene, field, settings, &results[i]);
    if (results[i].state == BENCH_DONE) continue;
    fprintf(stderr, "%s: %s: %s: %s\n", NAME, rows[i]->name, results[i].state == BENCH_SKIPPED ? "skipped" : "failed",
            results[i].problem);
  }
}

static bench_settings settings_of(const arguments *a) {
  bench_settings settings = {.width = a->size[0],
                             .height = a->size[1],
                             .frames = a->frames,
                             .quick = a->quick,
                             .compare = a->compare,
                             .camera = a->camera,
                             .ray_spacing = a->ray_spacing,
                             .sample = olx_sample_settings_default()};
  static const olx_select selectors[] = {OLX_SELECT_BEST, OLX_SELECT_CAGE, OLX_SELECT_BRICKS, OLX_SELECT_EXHAUSTIVE};
  settings.sample.tracer = (olx_tracer)a->tracer;
  settings.sample.select = selectors[a->select];
  settings.sample.hits = (olx_hits)a->hits;
  return settings;
}

// Prints the rows. Files named by --scene and --field must exist, at least one of --data's rows must, and none may
// fail. Skipped rows are reported.
static int report_results(const arguments *a, const bench_report *report) {
  uint32_t done = 0, failed = 0;
  for (uint32_t i = 0; i < report->count; i++) {
    done += report->results[i].state == BENCH_DONE;
    failed += report->results[i].state == BENCH_FAILED;
  }
  if (done) (a->json ? bench_report_json : bench_report_text)(report);
  else if (!a->scene) return failure(NAME, "no row could be run");
  return done && !failed ? EXIT_DONE : EXIT_FAILED;
}

static int run(gpu_device *device, const arguments *a, const bench_row **rows, uint32_t count) {
  bench_settings settings = settings_of(a);
  double copied;
  const VkDeviceSize bytes = (VkDeviceSize)(a->quick ? 4 : 256) << 20;
  if (!bench_copy_bandwidth(device, bytes, a->quick ? 2 : 20, &copied)) return failure(NAME, "%s", device->problem);
  settings.gigabytes = a->bandwidth > 0.0f ? (double)a->bandwidth : copied;
  bench_result *results = calloc(count, sizeof *results);
  if (!results) return failure(NAME, "out of memory");
  run_rows(device, a, &settings, rows, count, results);
  const bench_report report = {device, &settings, copied, a->bandwidth > 0.0f, count, rows, results};
  const int code = report_results(a, &report);
  free(results);
  return code;
}

static int open_and_run(const arguments *a, const bench_row **rows, uint32_t count) {
  gpu_device *device = calloc(1, sizeof *device);
  if (!device) return failure(NAME, "out of memory");
  int code;
  if (a->list) {
    code = gpu_device_list(device) ? EXIT_DONE : failure(NAME, "%s", device->problem);
  } else if (!gpu_device_open(
                 &(gpu_device_options){.validate = a->validate, .device = a->device, .compile_only = a->compile},
                 device)) {
    code = failure(NAME, "%s", device->problem);
  } else if (a->compile) {
    code = bench_compile(device, a->field, a->quick, a->json) ? EXIT_DONE : failure(NAME, "%s", device->problem);
    gpu_device_close(device);
  } else {
    code = device->timestamp_nanoseconds > 0.0 ? run(device, a, rows, count)
                                               : failure(NAME, "the device's queue has no timestamps");
    gpu_device_close(device);
    if (code == EXIT_DONE && device->validation_messages) {
      code = failure(NAME, "the validation layers found fault (see above)");
    }
  }
  free(device);
  return code;
}

static const option options[] = {
    {"--data", OPTION_TEXT, offsetof(arguments, data), "DIR",
     "cooked scenes and fields of the rows, as scripts/bench_gpu.sh makes them"},
    {"--rows", OPTION_TEXT, offsetof(arguments, rows), "NAME,...",
     "cornell-2048, cornell-256, sponza, living-room, kitchen, pandora; default all"},
    {"--scene", OPTION_TEXT, offsetof(arguments, scene), "FILE.olxs", "one cooked scene, in place of --data"},
    {"--field", OPTION_TEXT, offsetof(arguments, field), "FILE.olx", "its field"},
    {"--camera", OPTION_TEXT, offsetof(arguments, camera), "NAME", "default: the scene's first"},
    {"--size", OPTION_SIZE, offsetof(arguments, size), "1920x1080", "of the picture", 1, OLX_PICTURE_SIZE_MOST},
    {"--frames", OPTION_COUNT, offsetof(arguments, frames), "N", "frames to take the median of; default 100", 1,
     100000},
    {"--tracer", OPTION_CHOICE, offsetof(arguments, tracer), "texel|two-level|hiz", "default hiz"},
    {"--select", OPTION_CHOICE, offsetof(arguments, select), "best|cage|bricks|exhaustive", "default best"},
    {"--hits", OPTION_CHOICE, offsetof(arguments, hits), "shaded|stored",
     "light where rays end: of the surface there, or as a probe saw it; default shaded"},
    {"--ray-spacing", OPTION_COUNT, offsetof(arguments, ray_spacing), "1|2",
     "2 traces one pixel of each 2x2 a frame, in turn; default 1", 1, 2},
    {"--compare", OPTION_FLAG, offsetof(arguments, compare), NULL,
     "glossy light alone: two-level + cage against hi-Z + bricks, frames in turns"},
    {"--compile", OPTION_FLAG, offsetof(arguments, compile), NULL,
     "make every pipeline for --field, print what the compiler reports of each, and run nothing"},
    {"--bandwidth", OPTION_REAL, offsetof(arguments, bandwidth), "GB/s",
     "for the floors; default: as copies are measured"},
    {"--quick", OPTION_FLAG, offsetof(arguments, quick), NULL,
     "coarse shadows and hardly a warm-up: a test that it runs; with --compile, default tracer and selector alone"},
    {"--device", OPTION_COUNT, offsetof(arguments, device), "N", "one of --list; default: the best", 0, 15},
    {"--list", OPTION_FLAG, offsetof(arguments, list), NULL, "name the devices"},
    {"--validate", OPTION_FLAG, offsetof(arguments, validate), NULL,
     "with Vulkan's validation layers, which make it slow"},
    {0}};

int main(int argc, char **argv) {
  arguments a = {.size = {1920, 1080}, .frames = 100, .device = UINT32_MAX, .tracer = OLX_TRACER_HIZ, .ray_spacing = 1};
  command_line line = {
      .name = NAME,
      .summary = "Milliseconds of each pass on a Vulkan device, beside those of McGuire et al. 2017, Table 1.",
      .tables = {{options, &a}, {json_option, &a.json}}};
  int code;
  if (!parse_options(&line, argc, argv, &code)) return code;
  static const bench_row named = {
      .name = "scene", .title = "a scene and a field of one's own", .paper_diffuse = -1.0, .paper_glossy = -1.0};
  const bench_row *rows[MAX_ROWS] = {&named};
  uint32_t count = 1;
  if (!check_arguments(&a) || (a.data && !choose_rows(a.rows, rows, &count))) return EXIT_USAGE;
  code = open_and_run(&a, rows, count);
  if (fflush(stdout) == 0 && !ferror(stdout)) return code;
  return failure(NAME, "standard output: cannot write");
}
