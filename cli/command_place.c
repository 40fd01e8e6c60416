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

typedef struct place_options {
  olx_place_settings settings; // the defaults, replaced where options were given; its grid has counts alone
  place_picture picture;
  scene_options loading;
  const char *output;
  bool json;
} place_options;

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
  add_number(object, "field_bytes", (double)report->field_bytes);
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
         olx_place_method_name(set->settings.method), text_of_bytes(report->field_bytes).text,
         set->settings.resolution);
  printf("  covered    %.3f %%  of what rays from playable space meet (%" PRIu64 " held out), %.3f %% by area\n",
         100.0 * report->coverage, report->surfels, 100.0 * report->coverage_by_area);
  print_share("missed", report->missed, "could be covered: more probes, or a higher coverage");
  print_share("grazing", report->grazing,
              "seen at grazing angles, or with too large a texel, from wherever a probe may be");
  print_share("restricted", report->restricted, "seen only from where no probe may stand");
  if (set->count < set->settings.count)
    printf("  count      %u of %u probes asked for, because no further one was found to help\n", set->count,
           set->settings.count);
  print_unreached(report);
  print_share("unseen", report->unreachable, "of all surface: no side of it is seen from playable space");
  if (report->buried) printf("  buried     %u probes are inside geometry\n", report->buried);
  if (report->rejected) printf("  rejected   %u points of the grid, by the description\n", report->rejected);
  if (set->settings.optimize != OLX_OPTIMIZE_NONE) {
    printf("  reward     %.4f, from %.4f, after %u rounds of %s\n", report->reward_after, report->reward_before,
           report->rounds, olx_place_optimizer_name(set->settings.optimize));
    printf("             coverage was %.3f %% before\n", 100.0 * report->coverage_before);
  }
  if (report->voxel_metres > 0.0f)
    printf("  voxels     %g m, in %u tile%s\n", (double)report->voxel_metres, report->tiles,
           report->tiles == 1 ? "" : "s");
  printf("  seconds    %.2f\n", report->seconds);
}

static int write_place(const place_options *o, const olx_scene *scene, const olx_probe_set *set,
                       const command_files *files) {
  if (olx_probe_set_save(set, o->output) != OLX_OK) return library_failure("place");
  if (o->picture.path && draw_place_picture(scene, set, &o->picture) != OLX_OK) return library_failure("place");
  if (o->json) return print_place_json(set);
  print_beside_outputs(files);
  print_place(o->output, set);
  return EXIT_DONE;
}

static int place_probes(place_options *o, const olx_scene *scene, const command_files *files) {
  const int code = check_scene_files("place", files, scene);
  if (code != EXIT_DONE) return code;
  const olx_grid given = o->settings.grid;
  if (olx_scene_probe_grid(scene, given.count[0] ? given.count : NULL, &o->settings.grid) != OLX_OK)
    return library_failure("place");
  if (o->picture.path && find_picture_camera(scene, &o->picture) != OLX_OK) return library_failure("place");
  o->settings.marks = o->picture.path != NULL;
  o->settings.field_size = true;
  progress_line line;
  progress_begin(&line, "place", false);
  const olx_progress progress = progress_of(&line);
  olx_probe_set set;
  const olx_result result = olx_place(scene, &o->settings, &progress, &set);
  progress_end(&line);
  if (result == OLX_ERROR_CANCELLED) return failure("place", "%s: interrupted, nothing written", o->output);
  if (result != OLX_OK) return library_failure("place");
  const int printed = write_place(o, scene, &set, files);
  olx_probe_set_free(&set);
  return printed;
}

static const option place_basic_options[] = {
    {"-o", OPTION_TEXT, offsetof(place_options, output), "FILE.json", "the probes to write", 1},
    {"--count", OPTION_COUNT, offsetof(place_options, settings.count), "N",
     "number of probes; --method grid takes --grid instead", 1, OLX_PLACE_PROBES_MOST},
    {"--budget", OPTION_DOUBLE, offsetof(place_options, settings.budget_mb), "MB",
     "as many probes as fit, in 10^6 bytes at --resolution"},
    {"--resolution", OPTION_POWER_OF_TWO, offsetof(place_options, settings.resolution), "N",
     "texels along a map of light; default 512", OLX_RADIANCE_SIZE_LEAST, OLX_RADIANCE_SIZE_MOST},
    {"--picture", OPTION_TEXT, offsetof(place_options, picture.path), "FILE.png",
     "draw skeleton, probes and what is not covered"},
    {"--camera", OPTION_TEXT, offsetof(place_options, picture.camera), "NAME",
     "--picture: seen from there; default: the first"},
    {"--size", OPTION_SIZE, offsetof(place_options, picture.size), "1280x720", "--picture: pixels; default 1280x720", 1,
     OLX_PICTURE_SIZE_MOST},
    {0}};

static const option place_quality_options[] = {
    {"--coverage", OPTION_REAL, offsetof(place_options, settings.coverage), "SHARE",
     "cover: share of the coverable surfaces to cover; default 0.999, or 1 with --count or --budget", .most = 1.0f},
    {"--views", OPTION_COUNT, offsetof(place_options, settings.views), "N",
     "cover: probes that see each surface; default 1", OLX_PLACE_VIEWS_LEAST, OLX_PLACE_VIEWS_MOST},
    {"--max-footprint", OPTION_REAL, offsetof(place_options, settings.max_footprint), "SHARE",
     "larger texels on a surface do not count, in diagonals of the scene; default 0.05"},
    {"--min-cosine", OPTION_REAL, offsetof(place_options, settings.min_cosine), "C",
     "flatter views do not count; default 0.02"},
    {"--voxel-size", OPTION_REAL, offsetof(place_options, settings.voxel_size), "METRES",
     "side of voxels; default at least 0.25 where space is longer than 160 of them"},
    {"--voxels", OPTION_COUNT, offsetof(place_options, settings.voxels), "N",
     "voxels along the longest side of space, all in one tile", OLX_PLACE_VOXELS_LEAST, OLX_PLACE_VOXELS_MOST},
    {"--seed", OPTION_COUNT, offsetof(place_options, settings.seed), "N", "seed of all random choices; default 0", 0,
     UINT32_MAX},
    {0}};

static const option place_research_options[] = {
    {"--method", OPTION_CHOICE, offsetof(place_options, settings.method), "grid|sdf|medial|cover",
     "how positions are chosen; default cover: where probes see most"},
    {"--grid", OPTION_GRID, offsetof(place_options, settings.grid.count), "4x4x4",
     "grid, cover: positions along x, y, z; default: the scene's", 1, 1024},
    {"--surfels", OPTION_COUNT, offsetof(place_options, settings.surfels), "N", "samples of surfaces; default 14000",
     OLX_PLACE_SURFELS_LEAST, OLX_PLACE_SURFELS_MOST},
    {"--candidates", OPTION_COUNT, offsetof(place_options, settings.candidates), "N",
     "cover: positions tried; default 2000", OLX_PLACE_CANDIDATES_LEAST, OLX_PLACE_CANDIDATES_MOST},
    {"--refinements", OPTION_COUNT, offsetof(place_options, settings.refinements), "N",
     "cover: rounds of moves and swaps; default 8", 0, OLX_PLACE_REFINEMENTS_MOST},
    {"--optimize", OPTION_CHOICE, offsetof(place_options, settings.optimize), "none|gradient|gibbs",
     "move the probes; default none"},
    {"--reward", OPTION_CHOICE, offsetof(place_options, settings.reward), "best|sum",
     "reward that --optimize raises; default best"},
    {"--rounds", OPTION_COUNT, offsetof(place_options, settings.rounds), "N", "--optimize: most rounds; default 50",
     OLX_PLACE_ROUNDS_LEAST, OLX_PLACE_ROUNDS_MOST},
    {0}};

int command_place(int argc, char **argv) {
  place_options o = {.settings = olx_place_settings_default(NULL)};
  command_line line = {.name = "place",
                       .summary = "Find positions for probes from which a scene's surfaces are seen.",
                       .example = "octalux place room.gltf -o probes.json --picture probes.png",
                       .arguments = {"SCENE"},
                       .tables = {{place_basic_options, &o},
                                  {threads_option, &o.settings.threads},
                                  {json_option, &o.json},
                                  {place_quality_options, &o, "Quality"},
                                  {scene_loading_options, &o.loading, "Models"},
                                  {place_research_options, &o, RESEARCH}}};
  int code;
  if (!parse_options(&line, argc, argv, &code)) return code;
  const place_picture *picture = &o.picture;
  if (picture->path && !is_output_named(picture->path, ".png")) {
    return usage_error("place", "--picture: '%s' does not end in .png", picture->path);
  }
  if (!picture->path && (picture->camera || picture->size[0])) {
    return usage_error("place", "--camera and --size go with --picture");
  }
  const command_files files = {.inputs = {line.given[0]}, .outputs = {{o.output, true}, {picture->path, true}}};
  code = check_files("place", &files, o.json);
  if (code != EXIT_DONE) return code;
  olx_scene *scene = NULL;
  code = load_scene("place", line.given[0], &o.loading, &scene);
  if (code != EXIT_DONE) return code;
  code = place_probes(&o, scene, &files);
  olx_scene_free(scene);
  return code;
}
