// Repeats Figures 5.1 to 5.5 of the dissertation: two rooms separated by a wall that is complete or open at one end.
#include "experiment_list.h"

#include <math.h>
#include <stdio.h>

enum { GATHERED = 16, WAYS = 3 };

static const bench_column columns[] = {
    {"opening", "opening", BENCH_NAME, NULL, "in the wall, from floor to ceiling"},
    {"way", "way", BENCH_NAME, NULL, NULL},
    {"width", "opening", BENCH_COUNT, "m", NULL},
    {"lit", "lit room", BENCH_QUALITY, NULL, "mean indirect diffuse light in the picture of the room with the lamp"},
    {"dark", "far room", BENCH_QUALITY, NULL, "the same of the room without"},
    {"dark_over_lit", "far over lit", BENCH_QUALITY, "%", NULL},
    {"dark_over_path", "far over path", BENCH_QUALITY, "%", "the far room's mean over the path tracer's"},
    {"over_classic", "far over classic's", BENCH_QUALITY, "%", "behind a whole wall all of it is leaked"},
    {"dark_relative_mse", "far room: relative MSE", BENCH_QUALITY, NULL, NULL},
};

static const bench_plot plots[] = {
    {.caption = "Light in the far room as the opening grows", .x = "width", .y = "dark_over_lit", .series = "way"},
};

typedef struct rooms {
  bench *b;
  olx_scene *scene;
  olx_camera cameras[2]; // cameras in the lit and in the dark room
  bench_images *reference;
  bench_table *table;
  double width; // width of the opening in metres
} rooms;

static olx_result load_rooms(rooms *r, double width) {
  char name[48] = "builtin:two-rooms-sealed";
  if (width > 0.0) snprintf(name, sizeof name, "builtin:two-rooms-gap:%g", width);
  r->width = width;
  olx_result result = olx_scene_load(name, &r->scene);
  if (result == OLX_OK) result = olx_scene_find_camera(r->scene, "lit", &r->cameras[0]);
  if (result == OLX_OK) result = olx_scene_find_camera(r->scene, "dark", &r->cameras[1]);
  return result;
}

static void add_row(rooms *r, const char *opening, const char *way, bench_images *images, double classic_dark) {
  const bench_error lit = bench_error_of(images, r->reference, BENCH_DIFFUSE, 0);
  const bench_error dark = bench_error_of(images, r->reference, BENCH_DIFFUSE, 1);
  const bool black = !(dark.reference_mean > 0.0), truth = images == r->reference;
  FINDINGS_ROW(&r->b->found, r->table, TEXT_CELL(opening), TEXT_CELL(way), NUMBER_CELL(r->width), NUMBER_CELL(lit.mean),
               NUMBER_CELL(dark.mean), NUMBER_CELL(dark.mean / lit.mean),
               NUMBER_CELL(black || truth ? NAN : dark.mean / dark.reference_mean),
               NUMBER_CELL(truth ? NAN : dark.mean / classic_dark),
               NUMBER_CELL(black || truth ? NAN : dark.relative_mse));
}

static olx_result measure(rooms *r, const olx_field *field, const char *opening) {
  bench_images images[WAYS] = {0};
  bench_shown shown[WAYS];
  bench_way ways[WAYS] = {{.name = "field"}, {.name = "field, gathered"}, {.name = "classic"}};
  olx_result result = OLX_OK;
  for (uint32_t i = 0; i < WAYS && result == OLX_OK; ++i) {
    ways[i].field = field;
    ways[i].settings = bench_field_settings(r->b);
    ways[i].settings.diffuse_samples = GATHERED;
    if (i == 1) ways[i].settings.diffuse = OLX_DIFFUSE_TRACED;
    if (i == 2) ways[i].settings.method = OLX_METHOD_CLASSIC;
    shown[i] = (bench_shown){.way = ways[i].name, .images = &images[i], .camera = 1};
    result = bench_pictures(r->b, r->scene, r->cameras, 2, &ways[i], &images[i]);
  }
  if (result == OLX_OK) {
    const double classic_dark = bench_error_of(&images[2], r->reference, BENCH_DIFFUSE, 1).mean;
    for (uint32_t i = 0; i < WAYS; ++i) add_row(r, opening, ways[i].name, &images[i], classic_dark);
    add_row(r, opening, "path traced", r->reference, classic_dark);
  }
  char view[80];
  snprintf(view, sizeof view, r->width > 0.0 ? "far room, open for %s" : "far room, whole wall", opening);
  if (result == OLX_OK) result = bench_show(r->b, view, OLX_LAYER_INDIRECT_DIFFUSE, shown, WAYS, r->reference, 1);
  for (uint32_t i = 0; i < WAYS; ++i) bench_images_free(&images[i]);
  return result;
}

static olx_result run_rooms(rooms *r) {
  const olx_render_settings settings = bench_path_settings(r->b);
  const bench_probes probes = {.grid = {4, 2, 2}, .texels = 128};
  bench_bake bake = bench_bake_settings(r->b, true);
  bake.bounces = 2 * bench_bounces(r->b); // light reaches the far room only after many reflections
  char opening[32];
  if (r->width > 0.0) snprintf(opening, sizeof opening, "%.1f m", r->width);
  else snprintf(opening, sizeof opening, "none");
  olx_result result = olx_scene_probe_grid(r->scene, probes.grid, &bake.irradiance_grid);
  if (result == OLX_OK) {
    result = bench_reference(r->b, r->scene, r->cameras, 2, &settings, bake.bounces + 1, &r->reference);
  }
  if (result != OLX_OK) return result;
  bench_field made;
  result = bench_bake_field(r->b, r->scene, &probes, &bake, &made);
  if (result == OLX_OK) result = measure(r, made.field, opening);
  bench_field_close(&made);
  return result;
}

olx_result run_dissertation_rooms(bench *b) {
  static const double widths[] = {0.0, 0.2, 0.4, 0.8, 1.6};
  bench_table *table = FINDINGS_TABLE(&b->found, "rooms", "Indirect diffuse light in both rooms", columns, plots);
  for (uint32_t i = 0; i < sizeof widths / sizeof *widths; ++i) {
    if (b->options->quick && i != 0 && i != 3) continue;
    rooms r = {.b = b, .table = table};
    olx_result result = load_rooms(&r, widths[i]);
    if (result == OLX_OK) result = run_rooms(&r);
    olx_scene_free(r.scene);
    if (result != OLX_OK) return result;
  }
  return OLX_OK;
}
