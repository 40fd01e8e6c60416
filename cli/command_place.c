// octalux place: places the probes of a scene, prints what they cover, and saves them as JSON and as an image.
#include "commands.h"
#include "files.h"
#include "options.h"
#include "place_picture.h"
#include "report.h"
#include "scene_options.h"

#include <octalux/limits.h>
#include <octalux/place.h>

#include <inttypes.h>
#include <stdio.h>

// The options of the command; 0 means not given.
typedef struct place_options {
  uint32_t method, count, views, resolution, surfels, candidates, voxels, refinements, seed, threads, grid[3];
  uint32_t optimize, reward, rounds;
  float coverage, budget_mb, min_cosine, max_footprint, voxel_size;
} place_options;

static olx_result resolve_place_options(const olx_scene *scene, const place_options *given, olx_place_settings *s) {
  *s = olx_place_settings_default(scene);
  // The words of the option are in the order of the library's enumeration.
  s->method = (olx_place_method)given->method;
  s->optimize = (olx_place_optimizer)given->optimize;
  s->reward = (olx_place_reward)given->reward;
  s->count = given->count;
  s->coverage = given->coverage;
  s->budget_mb = (double)given->budget_mb;
  s->seed = given->seed;
  s->threads = given->threads;
  if (given->views) s->views = given->views;
  if (given->resolution) s->resolution = given->resolution;
  if (given->min_cosine > 0.0f) s->min_cosine = given->min_cosine;
  if (given->max_footprint > 0.0f) s->max_footprint = given->max_footprint;
  if (given->rounds) s->rounds = given->rounds;
  if (given->surfels) s->surfels = given->surfels;
  if (given->candidates) s->candidates = given->candidates;
  if (given->voxels) s->voxels = given->voxels;
  s->voxel_size = given->voxel_size;
  if (given->refinements != UINT32_MAX) s->refinements = given->refinements;
  return given->grid[0] ? olx_scene_probe_grid(scene, given->grid, &s->grid) : OLX_OK;
}

static int print_place_json(const olx_probe_set *set) {
  const olx_place_report *report = &set->report;
  cJSON *object = cJSON_CreateObject();
  add_text(object, "method", olx_place_method_name(set->settings.method));
  add_number(object, "count", set->count);
  add_number(object, "coverage", report->coverage);
  add_number(object, "visible", report->visible);
  add_number(object, "coverage_by_area", report->coverage_by_area);
  add_number(object, "coverable", report->coverable);
  add_number(object, "grazing", report->grazing);
  add_number(object, "restricted", report->restricted);
  add_number(object, "missed", report->missed);
  add_number(object, "unreachable", report->unreachable);
  add_number(object, "reached_m2", report->reached_m2);
  add_number(object, "unreached_m2", report->unreached_m2);
  add_number(object, "buried", report->buried);
  add_number(object, "rejected", report->rejected);
  add_number(object, "surfels", (double)report->surfels);
  add_number(object, "candidates", report->candidates);
  add_number(object, "space_voxels", (double)report->space_voxels);
  add_number(object, "tiles", report->tiles);
  add_float(object, "voxel_metres", report->voxel_metres);
  add_number(object, "field_bytes", (double)olx_light_field_bytes(set->count, set->settings.resolution));
  add_number(object, "seconds", report->seconds);
  if (set->settings.optimize != OLX_OPTIMIZE_NONE) {
    add_text(object, "optimize", olx_place_optimizer_name(set->settings.optimize));
    add_text(object, "reward", olx_place_reward_name(set->settings.reward));
    add_number(object, "coverage_before", report->coverage_before);
    add_number(object, "reward_before", report->reward_before);
    add_number(object, "reward_after", report->reward_after);
    add_number(object, "rounds", report->rounds);
  }
  cJSON *probes = cJSON_AddArrayToObject(object, "probes");
  for (uint32_t i = 0; i < set->count; ++i) {
    cJSON *probe = cJSON_CreateObject();
    add_position(probe, "position", set->origin, set->probes[i].position);
    add_text(probe, "origin", olx_probe_origin_name(set->probes[i].origin));
    add_float(probe, "gain", set->probes[i].gain);
    cJSON_AddBoolToObject(probe, "buried", set->probes[i].buried);
    cJSON_AddItemToArray(probes, probe);
  }
  return print_json("place", object);
}

static void print_share(const char *what, double share, const char *why) {
  if (share > 0.0) printf("  %-10s %.3f %%  %s\n", what, 100.0 * share, why);
}

#define LEAST_UNREACHED 1e-3 // as a share of the reached area

// Prints the surfaces that are not reached: openings narrower than two voxels are closed by the voxels that surfaces
// touch.
static void print_unreached(const olx_place_report *report) {
  if (report->unreached_m2 < LEAST_UNREACHED * report->reached_m2) return; // negligible
  printf("  unreached  %.1f m2  of surface, beside %.1f m2 that playable space sees: no opening of %g m, two voxels, "
         "leads there\n"
         "             from a camera. What matters of it wants a camera, a pinned probe, or a smaller --voxel-size\n",
         report->unreached_m2, report->reached_m2, 2.0 * (double)report->voxel_metres);
}

static void print_place(const char *path, const olx_probe_set *set) {
  const olx_place_report *report = &set->report;
  printf("%s: %u probes by %s, a field of about %s at %u texels a side\n", path, set->count,
         olx_place_method_name(set->settings.method),
         text_of_bytes(olx_light_field_bytes(set->count, set->settings.resolution)).text, set->settings.resolution);
  printf("  covered    %.3f %%  of what rays from playable space meet (%" PRIu64 " held out), %.3f %% by area\n",
         100.0 * report->coverage, report->surfels, 100.0 * report->coverage_by_area);
  print_share("missed", report->missed, "could be covered: more probes, or a higher coverage");
  print_share("grazing", report->grazing,
              "seen at grazing angles, or with too large a texel, from wherever a probe may be");
  print_share("restricted", report->restricted, "seen only from where no probe may stand");
  print_unreached(report);
  print_share("unseen", report->unreachable, "of all surface: no side of it is seen from playable space");
  if (report->buried) printf("  buried     %u probes are inside geometry\n", report->buried);
  if (report->rejected) printf("  rejected   %u points of the grid, by the description\n", report->rejected);
  if (set->settings.optimize != OLX_OPTIMIZE_NONE) {
    printf("  reward     %.4f, from %.4f, after %u rounds of %s\n", report->reward_after, report->reward_before,
           report->rounds, olx_place_optimizer_name(set->settings.optimize));
    printf("             coverage was %.3f %% before\n", 100.0 * report->coverage_before);
  }
  printf("  seconds    %.2f\n", report->seconds);
}

static int write_place(const olx_scene *scene, const olx_probe_set *set, const place_picture *picture,
                       const command_files *files, bool json) {
  const char *path = files->outputs[0].path;
  if (olx_probe_set_save(set, path) != OLX_OK) return library_failure("place");
  if (picture->path && draw_place_picture(scene, set, picture) != OLX_OK) return library_failure("place");
  if (json) return print_place_json(set);
  print_beside_outputs(files);
  print_place(path, set);
  return EXIT_DONE;
}

static int place_probes(const olx_scene *scene, const place_options *given, const place_picture *picture,
                        const command_files *files, bool json) {
  const char *path = files->outputs[0].path;
  const int code = check_scene_files("place", files, scene);
  if (code != EXIT_DONE) return code;
  olx_place_settings settings;
  if (resolve_place_options(scene, given, &settings) != OLX_OK) return library_failure("place");
  if (picture->path && find_picture_camera(scene, picture) != OLX_OK) return library_failure("place");
  settings.marks = picture->path != NULL;
  progress_line line;
  progress_begin(&line, "place", false);
  const olx_progress progress = progress_of(&line);
  olx_probe_set set;
  const olx_result result = olx_place(scene, &settings, &progress, &set);
  progress_end(&line);
  if (result == OLX_ERROR_CANCELLED) return failure("place", "%s: interrupted, nothing written", path);
  if (result != OLX_OK) return library_failure("place");
  const int printed = write_place(scene, &set, picture, files, json);
  olx_probe_set_free(&set);
  return printed;
}

int command_place(int argc, char **argv) {
  place_options given = {.method = OLX_PLACE_COVER, .refinements = UINT32_MAX};
  place_picture picture = {0};
  const char *output = NULL;
  bool json = false;
  scene_options loading = {0};
  const option options[] = {
      {"-o", OPTION_TEXT, &output, "FILE.json", "the probes to write", 1, 0},
      {"--count", OPTION_COUNT, &given.count, "N", "so many probes (grid: --grid)", 1, OLX_PLACE_PROBES_MOST},
      {"--budget", OPTION_REAL, &given.budget_mb, "MB", "as many as fit, in 10^6 bytes at --resolution", 0, 0},
      {"--resolution", OPTION_POWER_OF_TWO, &given.resolution, "N", "texels along a map of light; default 512",
       OLX_RADIANCE_SIZE_LEAST, OLX_RADIANCE_SIZE_MOST},
      {"--picture", OPTION_TEXT, &picture.path, "FILE.png", "draw skeleton, probes and what is not covered", 0, 0},
      {"--camera", OPTION_TEXT, &picture.camera, "NAME", "--picture: seen from there; default: the first", 0, 0},
      {"--size", OPTION_SIZE, picture.size, "1280x720", "--picture: pixels; default 1280x720", 1,
       OLX_PICTURE_SIZE_MOST},
      {"--threads", OPTION_COUNT, &given.threads, "N", "default 0: every processor; the result is the same", 0, 4096},
      {"--json", OPTION_FLAG, &json, NULL, "print one JSON object", 0, 0},
      GROUP_ROW("Quality"),
      {"--coverage", OPTION_REAL, &given.coverage, "SHARE", "cover: of what can be covered; default 0.999", 0, 0},
      {"--views", OPTION_COUNT, &given.views, "N", "cover: probes that see each surface; default 1",
       OLX_PLACE_VIEWS_LEAST, OLX_PLACE_VIEWS_MOST},
      {"--max-footprint", OPTION_REAL, &given.max_footprint, "SHARE",
       "larger texels on a surface do not count, in diagonals of the scene; default 0.05", 0, 0},
      {"--min-cosine", OPTION_REAL, &given.min_cosine, "C", "flatter views do not count; default 0.02", 0, 0},
      {"--voxel-size", OPTION_REAL, &given.voxel_size, "METRES",
       "of space longer than 160 of them, in tiles; default 0.25", 0, 0},
      {"--voxels", OPTION_COUNT, &given.voxels, "N", "along the longest side of space, in one tile",
       OLX_PLACE_VOXELS_LEAST, OLX_PLACE_VOXELS_MOST},
      {"--seed", OPTION_COUNT, &given.seed, "N", "of all random choices; default 0", 0, UINT32_MAX},
      GROUP_ROW("Models"),
      SCENE_OPTION_ROWS(loading),
      RESEARCH_ROW,
      {"--method", OPTION_CHOICE, &given.method, "grid|sdf|medial|cover", "default cover: where they see most", 0, 0},
      {"--grid", OPTION_GRID, given.grid, "4x4x4", "grid: probes along x, y, z; default: the scene's", 1, 1024},
      {"--surfels", OPTION_COUNT, &given.surfels, "N", "cover: samples of surfaces; default 14000",
       OLX_PLACE_SURFELS_LEAST, OLX_PLACE_SURFELS_MOST},
      {"--candidates", OPTION_COUNT, &given.candidates, "N", "cover: positions tried; default 2000",
       OLX_PLACE_CANDIDATES_LEAST, OLX_PLACE_CANDIDATES_MOST},
      {"--refinements", OPTION_COUNT, &given.refinements, "N", "cover: rounds of moves and swaps; default 8", 0,
       OLX_PLACE_REFINEMENTS_MOST},
      {"--optimize", OPTION_CHOICE, &given.optimize, "none|gradient|gibbs", "move the probes; default none", 0, 0},
      {"--reward", OPTION_CHOICE, &given.reward, "best|sum", "what --optimize raises; default best", 0, 0},
      {"--rounds", OPTION_COUNT, &given.rounds, "N", "--optimize: at most so many; default 50", OLX_PLACE_ROUNDS_LEAST,
       OLX_PLACE_ROUNDS_MOST},
  };
  command_line line = {.name = "place",
                       .summary = "Find positions for probes from which a scene's surfaces are seen.",
                       .example = "octalux place room.gltf -o probes.json --picture probes.png",
                       .arguments = {"SCENE"},
                       .options = options,
                       .option_count = sizeof options / sizeof options[0]};
  int code;
  if (!parse_options(&line, argc, argv, &code)) return code;
  if (picture.path && !is_output_named(picture.path, ".png")) {
    return usage_error("place", "--picture: '%s' does not end in .png", picture.path);
  }
  if (!picture.path && (picture.camera || picture.size[0])) {
    return usage_error("place", "--camera and --size go with --picture");
  }
  const command_files files = {.inputs = {line.given[0]}, .outputs = {{output, true}, {picture.path, true}}};
  code = check_files("place", &files, json);
  if (code != EXIT_DONE) return code;
  olx_scene *scene = NULL;
  code = load_scene("place", line.given[0], &loading, &scene);
  if (code != EXIT_DONE) return code;
  code = place_probes(scene, &given, &picture, &files, json);
  olx_scene_free(scene);
  return code;
}
