// octalux bake: bakes a scene into a field file, or prints the cost of the bake without running it.
#include "bake_budget.h"
#include "bake_device.h"
#include "bake_driver.h"
#include "bake_options.h"
#include "bake_placement.h"
#include "commands.h"
#include "files.h"
#include "options.h"
#include "report.h"
#include "scene_options.h"
#include "work_options.h"

#include <octalux/bake.h>

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <unistd.h>

#ifdef __GLIBC__
#include <malloc.h>
#endif

static int print_bake_json(const olx_bake_settings *settings, const olx_bake_stats *stats, const work_report *units) {
  cJSON *object = cJSON_CreateObject();
  add_number(object, "probes", light_probe_count(settings));
  add_number(object, "radiance_size", settings->radiance_size);
  add_number(object, "irradiance_probes", irradiance_probe_count(settings));
  add_number(object, "buried", stats->buried);
  add_number(object, "irradiance_buried", stats->irradiance_buried);
  add_number(object, "rays", (double)stats->rays);
  add_number(object, "primary_rays", (double)stats->primary_rays);
  if (units) add_number(object, "reused_rays", (double)stats->reused_rays);
  add_number(object, "seconds", stats->seconds);
  if (olx_bake_keeps_probe_light(settings)) add_number(object, "irradiance_seconds", stats->irradiance_seconds);
  add_number(object, "capture_seconds", stats->capture_seconds);
  add_number(object, "write_seconds", stats->write_seconds);
  if (settings->light == OLX_LIGHT_CACHE) {
    add_number(object, "surfels", stats->surfels);
    add_number(object, "noise", stats->noise);
    add_number(object, "light_seconds", stats->light_seconds);
    add_number(object, "light_bytes", (double)stats->light_bytes);
  }
  if (stats->volume_probes) {
    add_number(object, "volume_probes", stats->volume_probes);
    add_number(object, "volume_cells", stats->volume_cells);
    add_number(object, "volume_bytes", (double)stats->volume_bytes);
    add_number(object, "volume_unserved", stats->volume_unserved);
    add_number(object, "volume_seconds", stats->volume_seconds);
  }
  if (settings->classic) add_number(object, "classic_seconds", stats->classic_seconds);
  if (settings->relight) add_number(object, "relight_seconds", stats->relight_seconds);
  add_number(object, "embree_seconds", stats->embree_seconds);
  if (settings->raster) {
    cJSON_AddStringToObject(object, "device", settings->raster->name);
    add_number(object, "raster_seconds", stats->raster_seconds);
    add_number(object, "raster_rays", (double)stats->raster_rays);
  }
  if (settings->bounce_gather == OLX_GATHER_TRACED) add_number(object, "unseen", stats->unseen);
  add_number(object, "peak_memory_bytes", (double)stats->peak_memory_bytes);
  add_number(object, "file_bytes", (double)stats->file_bytes);
  if (units) add_work_report(object, units);
  return print_json("bake", object);
}

static void print_bake(const char *path, const olx_bake_settings *settings, const olx_bake_stats *stats) {
  printf("%s: %s\n", path, text_of_bytes(stats->file_bytes).text);
  const bool probe_light = olx_bake_keeps_probe_light(settings);
  printf("  probes   %.0f of light, %u of them inside geometry", light_probe_count(settings), stats->buried);
  if (probe_light)
    printf("; %.0f of irradiance, %u inside", irradiance_probe_count(settings), stats->irradiance_buried);
  printf("\n  rays     %" PRIu64 ", %" PRIu64 " of them from probes\n", stats->rays, stats->primary_rays);
  printf("  seconds  %.2f, and %.2f to write; %.2f of them for what light field probes see", stats->seconds,
         stats->write_seconds, stats->capture_seconds);
  if (probe_light) printf(", %.2f for irradiance probes", stats->irradiance_seconds);
  printf("\n");
  if (settings->light == OLX_LIGHT_CACHE) {
    printf("  light    %u surfels with %s of links, noise %.2f %%; %.2f of these seconds\n", stats->surfels,
           text_of_bytes(stats->light_bytes).text, 100.0 * stats->noise, stats->light_seconds);
  }
  if (stats->volume_probes) {
    printf("  volume   %u probes, %s (%.0f bytes a probe); %.2f of these seconds\n", stats->volume_probes,
           text_of_bytes(stats->volume_bytes).text, (double)stats->volume_bytes / stats->volume_probes,
           stats->volume_seconds);
    printf("  unserved %.3f %% of the surfaces that probes see have no volume probe in their room\n",
           100.0 * stats->volume_unserved);
  }
  if (settings->bounce_gather == OLX_GATHER_TRACED) {
    printf("  unseen   %.3f %% of the rays between surfaces end where no probe sees\n", 100.0 * stats->unseen);
  }
  if (settings->classic) printf("  classic  %.2f of these seconds\n", stats->classic_seconds);
  if (settings->relight) printf("  relight  %.2f of these seconds\n", stats->relight_seconds);
  if (settings->raster) {
    printf("  device   %s: %.2f of these seconds to rasterise, and %.3f %% of the rays from probes cast\n",
           settings->raster->name, stats->raster_seconds,
           100.0 * (double)stats->raster_rays / (double)(stats->primary_rays ? stats->primary_rays : 1));
  }
  if (stats->embree_seconds > 0.0) {
    printf("  Embree   %.2f seconds for the rays from probes alone: the bake takes %.2f times that\n",
           stats->embree_seconds, stats->seconds / stats->embree_seconds);
  }
  printf("  memory   %s at most\n", text_of_bytes(stats->peak_memory_bytes).text);
}

static void add_bytes(cJSON *object, const char *key, uint64_t bytes) {
  if (bytes == UINT64_MAX) cJSON_AddNullToObject(object, key);
  else add_number(object, key, (double)bytes);
}

static int print_plan_json(const olx_bake_settings *settings, const olx_bake_sizes *sizes,
                           const olx_bake_memory *memory, double seconds, bool fits) {
  cJSON *object = cJSON_CreateObject();
  add_number(object, "probes", (double)sizes->probes);
  add_number(object, "radiance_size", settings->radiance_size);
  add_number(object, "irradiance_probes", (double)sizes->irradiance_probes);
  add_bytes(object, "file_bytes", sizes->file_bytes);
  add_bytes(object, "expected_bytes", sizes->expected_bytes);
  add_bytes(object, "link_bytes", sizes->link_bytes);
  add_bytes(object, "device_bytes", sizes->device_bytes);
  add_bytes(object, "memory_bytes", sizes->memory_bytes);
  add_bytes(object, "most_memory_bytes", memory->most_bytes);
  add_bytes(object, "least_memory_bytes", memory->least_bytes);
  add_bytes(object, "work_bytes", sizes->work_bytes);
  add_bytes(object, "available_disk_bytes", sizes->available_disk_bytes);
  add_bytes(object, "available_memory_bytes", sizes->available_memory_bytes);
  add_number(object, "rays", (double)sizes->rays);
  add_number(object, "estimated_seconds", seconds);
  cJSON_AddBoolToObject(object, "fits", fits);
  return print_json("bake", object);
}

static const char *available(uint64_t bytes, size_text *text) {
  *text = text_of_bytes(bytes);
  return bytes == UINT64_MAX ? "an unknown amount" : text->text;
}

static void print_plan(const char *path, const olx_bake_settings *settings, const olx_bake_sizes *sizes,
                       const olx_bake_memory *memory, double seconds) {
  size_text free_bytes;
  printf("%s: nothing is baked; a bake would be\n", path);
  printf("  probes   %" PRIu64 " of light, %" PRIu64 " of irradiance\n", sizes->probes, sizes->irradiance_probes);
  printf("  maps     %u x %u texels\n", settings->radiance_size, settings->radiance_size);
  printf("  file     about %s, %" PRIu64 " bytes at least; %s free\n", text_of_bytes(sizes->expected_bytes).text,
         sizes->file_bytes, available(sizes->available_disk_bytes, &free_bytes));
  if (sizes->device_bytes) printf("  GPU      %s\n", text_of_bytes(sizes->device_bytes).text);
  else printf("  GPU      nothing: spherical harmonics are read on the CPU alone\n");
  printf("  memory   %s beside the scene, and %s at most for the light of the scene; %s available\n",
         text_of_bytes(sizes->memory_bytes).text, text_of_bytes(sizes->link_bytes).text,
         available(sizes->available_memory_bytes, &free_bytes));
  if (memory->least_bytes != UINT64_MAX) {
    printf("           %.0f MB at most with the scene and the program; --memory %.0f is the least that is accepted\n",
           (double)memory->most_bytes * 1e-6, (double)memory->least_bytes * 1e-6);
  }
  printf("  work     %s at most in a work folder until it is done\n", text_of_bytes(sizes->work_bytes).text);
  printf("  rays     %.3g\n", (double)sizes->rays);
  printf("  seconds  about %.3g, from a few probes; half and twice as long are possible\n", seconds);
}

typedef struct bake_command {
  bake_options given;
  work_options work;
  scene_options loading;
  const char *output;
  double budget_mb;  // 0: not given
  uint32_t progress; // 1: shown even when nobody watches; 2: a line of JSON for each unit
  bool dry_run, json;
  double memory_mb; // the most memory, 10^6 bytes; 0: no limit
  work_line units;
  uint32_t device;
  bool validate;
  const bake_driver *driver; // NULL: one process bakes
} bake_command;

enum { DEVICE_CPU, DEVICE_VULKAN };

// Returns whether a bake fits, or says why a limit on its memory is too low for it.
static bool is_within_limit(const olx_bake_settings *settings, const olx_bake_memory *memory, char *why,
                            size_t size_bytes) {
  const uint64_t limit = settings->memory_limit_bytes;
  if (!limit || memory->least_bytes == UINT64_MAX || limit >= memory->least_bytes) return true;
  snprintf(why, size_bytes, "a limit of %.0f MB of memory is too low: this bake needs %.0f MB at least",
           (double)limit * 1e-6, (double)memory->least_bytes * 1e-6);
  return false;
}

// Prints sizes and time of a bake without running it. The exit code and the last line report a bake that does not fit.
static int plan_bake(const olx_scene *scene, const bake_command *c, const char *path) {
  const olx_bake_settings *settings = &c->given.settings;
  olx_bake_sizes sizes;
  bool fits = olx_bake_measure(scene, settings, path, &sizes) == OLX_OK;
  if (!fits && !sizes.probes) return library_failure("bake");
  char why[1024] = "";
  if (!fits) snprintf(why, sizeof why, "%s", olx_last_error());
  progress_line line;
  double seconds;
  progress_begin(&line, "bake", c->progress == 1);
  const olx_progress progress = progress_of(&line);
  olx_bake_memory memory = {UINT64_MAX, UINT64_MAX}; // unknown
  olx_result result = OLX_OK;
  if (fits) result = olx_bake_measure_memory(scene, settings, path, &progress, &memory);
  fits = fits && is_within_limit(settings, &memory, why, sizeof why);
  if (result == OLX_OK) result = olx_bake_estimate_seconds(scene, settings, &progress, &seconds);
  progress_end(&line);
  if (result == OLX_ERROR_CANCELLED) return failure("bake", "interrupted");
  if (result != OLX_OK) return library_failure("bake");
  int code = EXIT_DONE;
  if (c->json) code = print_plan_json(settings, &sizes, &memory, seconds, fits);
  else print_plan(path, settings, &sizes, &memory, seconds);
  return fits ? code : failure("bake", "%s", why);
}

// Prints where a bake stores its results, before it begins.
static void announce_work(const olx_scene *scene, const olx_bake_settings *settings, const char *path) {
  olx_bake_sizes sizes;
  if (!settings->work.folder || olx_bake_measure(scene, settings, path, &sizes) != OLX_OK) return;
  fprintf(stderr, "octalux bake: results are kept in %s, %s at most\n", settings->work.folder,
          text_of_bytes(sizes.work_bytes).text);
}

static int report_failure(olx_result result, const olx_bake_settings *settings, const char *path) {
  const char *folder = settings->work.folder;
  if (result == OLX_ERROR_CANCELLED && folder) {
    return failure("bake",
                   "%s: interrupted, nothing written; %s holds what is done, and the same command%s goes on from it",
                   settings->work.parts ? folder : path, folder, settings->work.fresh ? " without --fresh" : "");
  }
  if (result == OLX_ERROR_CANCELLED) return failure("bake", "%s: interrupted, nothing written", path);
  const int code = library_failure("bake");
  return result == OLX_ERROR_INCOMPLETE ? EXIT_AGAIN : code;
}

static int print_part(const olx_bake_work *work, const work_report *units, bool explain, bool json) {
  if (!json) {
    printf("%s: part %u of %u made %u units; all are there\n", work->folder, work->part, work->parts, units->made);
    if (explain) print_work_report(units);
    return EXIT_DONE;
  }
  cJSON *object = cJSON_CreateObject();
  add_number(object, "part", work->part);
  add_number(object, "parts", work->parts);
  add_number(object, "units_made", units->made);
  if (explain) add_work_report(object, units);
  return print_json("bake", object);
}

// Lets the driver compute the units; *collects: this process then makes the field of them.
static int drive(const olx_scene *scene, bake_command *c, const char *path, bool *collects) {
  driven_bake bake = {scene, c->given.settings, path, !c->units.json && (c->progress == 1 || isatty(STDERR_FILENO))};
  *collects = true;
  if (!c->driver) return EXIT_DONE;
  const int code = c->driver->run(c->driver->user, &bake, collects);
  c->given.settings = bake.settings;
  return code;
}

static int bake_scene(const olx_scene *scene, const bake_command *c, const char *path) {
  const olx_bake_settings *settings = &c->given.settings;
  progress_line line;
  progress_begin(&line, "bake", c->progress == 1);
  if (c->units.json && settings->work.folder) line.shown = false; // lines for units replace the progress line
  if (line.shown) announce_work(scene, settings, path);
  const olx_progress progress = progress_of(&line);
  olx_bake_stats stats;
  const olx_result result = olx_bake(scene, settings, path, &progress, &stats);
  progress_end(&line);
  if (result != OLX_OK) return report_failure(result, settings, path);
  if (settings->work.parts) return print_part(&settings->work, &c->units.report, c->work.explain, c->json);
  const work_report *units = c->work.explain ? &c->units.report : NULL;
  if (c->json) return print_bake_json(settings, &stats, units);
  print_bake(path, settings, &stats);
  if (!units) return EXIT_DONE;
  printf("  reused   %" PRIu64 " of %" PRIu64 " rays from before an edit of the scene\n", stats.reused_rays,
         stats.rays);
  print_work_report(units);
  return EXIT_DONE;
}

static int check_given(const command_line *line, const bake_command *c) {
  const olx_bake_settings *s = &c->given.settings;
  const bool shapes_classic =
      was_given(line, "--classic-size") || was_given(line, "--cube-size") || was_given(line, "--sharpness");
  if (!c->output && (!c->work.part || c->dry_run)) {
    return usage_error("bake", "-o FILE.olx is missing (see octalux bake --help)");
  }
  if (!s->classic && shapes_classic) {
    return usage_error("bake", "--classic-size, --cube-size and --sharpness go with --classic");
  }
  if (was_given(line, "--reference-paths") && s->light != OLX_LIGHT_REFERENCE) {
    return usage_error("bake", "--reference-paths goes with --light reference");
  }
  if (s->relight && s->light == OLX_LIGHT_REFERENCE) {
    return usage_error("bake", "--relight needs the light of the scene, not --light reference");
  }
  if (c->validate && c->device != DEVICE_VULKAN) return usage_error("bake", "--validate goes with --device vulkan");
  if (c->given.probes && was_given(line, "--grid")) {
    return usage_error("bake", "--grid and --probes exclude each other");
  }
  return EXIT_DONE;
}

// Lets the driver run the parts of the bake, if there is one, and bakes or collects what is left in this process.
static int bake_shared(const olx_scene *scene, bake_command *c, const char *path) {
  bool collects;
  const int driven = drive(scene, c, path, &collects);
  return driven == EXIT_DONE && collects ? bake_scene(scene, c, path) : driven;
}

// Chooses what the command line and the scene leave open: probes, and with a budget the size of maps.
static int choose_open(const olx_scene *scene, const command_line *line, bake_command *c) {
  const bool budget = c->budget_mb > 0.0, shared = (c->work.part || c->driver) && !c->dry_run;
  const bool given = c->given.probes || was_given(line, "--grid");
  const bool places = budget ? !given : leaves_probes_open(scene, line, &c->given);
  if (places && shared) {
    return usage_error("bake", "a bake in shares needs --probes (octalux place) or --grid here, because every call or "
                               "rank would place probes anew");
  }
  if (budget) return fit_bake_budget(scene, line, c->budget_mb, &c->given);
  return places ? place_open_probes(scene, &c->given) : EXIT_DONE;
}

// Runs or estimates the bake that the options describe.
static int run_bake(const olx_scene *scene, bake_command *c) {
  bake_device *device = NULL;
  int code = resolve_work_options(scene, &c->work, c->output, &c->given.settings, &c->units);
  const char *path = c->output ? c->output : c->given.settings.work.folder;
  if (code == EXIT_DONE && c->device == DEVICE_VULKAN)
    code = open_bake_device(scene, c->validate, &c->given.settings, &device);
  if (code == EXIT_DONE) code = c->dry_run ? plan_bake(scene, c, path) : bake_shared(scene, c, path);
  close_bake_device(device);
  return code;
}

static const option output_option[] = {
    {"-o", OPTION_TEXT, 0, "FILE.olx", "the field to write; a part writes none"},
    {0},
};

static const option run_options[] = {
    {"--device", OPTION_CHOICE, offsetof(bake_command, device), "cpu|vulkan",
     "how light field probes look around: by rays, or on a Vulkan device by cube maps; default cpu"},
    {"--budget", OPTION_DOUBLE, offsetof(bake_command, budget_mb), "MB",
     "place probes, and take the largest maps whose field fits, in 10^6 bytes; keeps --probes, --grid, "
     "--radiance-size"},
    {"--memory", OPTION_DOUBLE, offsetof(bake_command, memory_mb), "MB",
     "the most memory, in 10^6 bytes, for the same field; default: no limit"},
    {"--dry-run", OPTION_FLAG, offsetof(bake_command, dry_run), NULL,
     "bake nothing: print size, memory and an estimate of the time"},
    {"--progress", OPTION_FLAG_WORD, offsetof(bake_command, progress), "json",
     "show progress even without a terminal; json: a line for each unit of a work folder"},
    {0},
};

static const option instructions_option[] = {
    {"--isa", OPTION_CHOICE, 0, "best|sse2|sse4.2|avx|avx2|avx512",
     "instructions that Embree uses, for the same bytes on unlike machines; default best"},
    {0}};

static const option measure_options[] = {{"--measure-embree", OPTION_FLAG,
                                          offsetof(bake_command, given.settings.measure_embree), NULL,
                                          "also time Embree alone on the rays from probes"},
                                         {"--validate", OPTION_FLAG, offsetof(bake_command, validate), NULL,
                                          "vulkan: check every call with the validation layers"},
                                         {0}};

// Makes the C library return every released block of memory to the system at once: by default glibc keeps more of them
// the larger they get. Other C libraries, such as musl, have no such setting.
static void return_released_memory(void) {
#ifdef __GLIBC__
  mallopt(M_MMAP_THRESHOLD, 1 << 17);
#endif
}

int command_bake(int argc, char **argv) { return bake_with(NULL, argc, argv); }

int bake_with(const bake_driver *driver, int argc, char **argv) {
  bake_command c = {.given = bake_options_begin(), .driver = driver, .work.driven = driver != NULL};
  command_line line = {.name = driver ? driver->name : "bake",
                       .summary = driver ? driver->summary
                                         : "Bake a scene's light into a field: what its probes see, and the "
                                           "light there.",
                       .example = driver ? driver->example : "octalux bake room.gltf --probes probes.json -o room.olx",
                       .arguments = {"SCENE"},
                       .tables = {{output_option, &c.output},
                                  {bake_basic_options, &c.given},
                                  {threads_option, &c.given.settings.threads},
                                  {run_options, &c},
                                  {json_option, &c.json},
                                  {bake_quality_options, &c.given, "Quality"},
                                  {work_folder_options, &c.work, "Bakes that resume, and farms"},
                                  {instructions_option, &c.loading.instructions},
                                  {scene_loading_options, &c.loading, "Models"},
                                  {bake_research_options, &c.given, RESEARCH},
                                  {measure_options, &c}}};
  int code;
  if (!parse_options(&line, argc, argv, &code)) return code;
  code = check_given(&line, &c);
  if (code != EXIT_DONE) return code;
  c.given.settings.memory_limit_bytes = (uint64_t)fmin(c.memory_mb * 1e6, 1e18);
  if (c.memory_mb > 0.0 || c.dry_run) return_released_memory();
  const command_files files = {.inputs = {line.given[0], c.given.probes}, .outputs = {{c.output, false}}};
  code = check_files("bake", &files, c.json);
  if (code == EXIT_DONE) code = check_work_options(&c.work, c.dry_run);
  if (code != EXIT_DONE) return code;
  if (driver && !driver->checked(driver->user)) return EXIT_FAILED;
  olx_scene *scene = NULL;
  code = load_scene("bake", line.given[0], &c.loading, &scene);
  if (code != EXIT_DONE) return code;
  c.units.json = c.progress == 2;
  code = check_scene_files("bake", &files, scene);
  if (code == EXIT_DONE && resolve_bake_options(scene, &line, &c.given) != OLX_OK) code = library_failure("bake");
  if (code == EXIT_DONE) code = choose_open(scene, &line, &c);
  if (code == EXIT_DONE) code = run_bake(scene, &c);
  release_bake_settings(&c.given.settings);
  olx_scene_free(scene);
  return code;
}
