// Measures how much light further bounces add, by both methods of gathering them.
#include "experiment_list.h"

#include <stdio.h>

enum { MANY = 16 };

static const bench_column columns[] = {
    {"bounces", "light after", BENCH_NAME, NULL,
     "of indirect light; many: 16 in the field, all of them in the reference"},
    {"gather", "gathered from", BENCH_NAME, NULL, NULL},
    {"count", "bounces", BENCH_COUNT, NULL, NULL},
    {.kind = BENCH_DIFFERENCE},
    {"mean", "mean", BENCH_QUALITY, NULL, "of indirect diffuse light in the picture"},
    {"bake_s", "bake", BENCH_TIME, "s", "processor time"},
};

static const bench_plot plots[] = {
    {.caption = "Light too much", .x = "count", .y = "bias", .series = "gather", .log_x = true},
    {.caption = "Light in the picture", .x = "count", .y = "mean", .series = "gather", .log_x = true},
    {.caption = "Time of the bake", .x = "count", .y = "bake_s", .series = "gather", .log_x = true},
};

static const olx_bounce_gather ways[] = {OLX_GATHER_IRRADIANCE, OLX_GATHER_TRACED};
static const char *const gather_names[] = {[OLX_GATHER_IRRADIANCE] = "irradiance maps", [OLX_GATHER_TRACED] = "rays"};

// Measures an image with `bounces`, from a field whose maps hold one less.
static olx_result measure(bench *b, const olx_scene *scene, const olx_camera *camera, uint32_t bounces,
                          olx_bounce_gather gather, bench_images *reference, bench_images *images, bench_table *table) {
  const uint32_t side = b->options->quick ? 2 : 4;
  const bench_probes probes = {.grid = {side, side, side}, .texels = 64};
  bench_bake bake = bench_bake_settings(b, false);
  bake.bounces = bounces - 1;
  bake.gather = gather;
  olx_result result = olx_scene_probe_grid(scene, probes.grid, &bake.irradiance_grid);
  if (result != OLX_OK) return result;
  bench_field made;
  bench_quality quality;
  result = bench_bake_field(b, scene, &probes, &bake, &made);
  if (result == OLX_OK) {
    const bench_way way = {.name = gather_names[gather], .field = made.field, .settings = bench_cage_settings(b)};
    result = bench_pictures(b, scene, camera, 1, &way, images);
  }
  if (result == OLX_OK) result = bench_compare(b, images, reference, BENCH_DIFFUSE, 0, &quality);
  if (result == OLX_OK) {
    char name[16] = "many";
    if (bounces < MANY) snprintf(name, sizeof name, "%u", bounces);
    bench_cell cells[BENCH_DIFFERENCE_COLUMNS];
    bench_quality_cells(&quality, cells);
    FINDINGS_ROW(&b->found, table, TEXT_CELL(name), TEXT_CELL(gather_names[gather]), NUMBER_CELL(bounces),
                 DIFFERENCE_CELLS(cells), NUMBER_CELL(quality.error.mean), NUMBER_CELL(made.bake_seconds));
  }
  bench_field_close(&made);
  return result;
}

static olx_result run_count(bench *b, const olx_scene *scene, uint32_t bounces, bench_table *table) {
  olx_camera camera;
  const olx_render_settings settings = bench_path_settings(b);
  bench_images *reference, images[2] = {0};
  bench_shown shown[2];
  char view[32];
  olx_result result = olx_scene_find_camera(scene, NULL, &camera);
  if (result != OLX_OK) return result;
  result =
      bench_reference(b, scene, &camera, 1, &settings, bounces < MANY ? bounces : OLX_BOUNCES_INFINITE, &reference);
  for (uint32_t i = 0; i < 2 && result == OLX_OK; ++i) {
    shown[i] = (bench_shown){.way = gather_names[ways[i]], .images = &images[i]};
    result = measure(b, scene, &camera, bounces, ways[i], reference, &images[i], table);
  }
  if (bounces < MANY) snprintf(view, sizeof view, "%u bounce%s", bounces, bounces > 1 ? "s" : "");
  else snprintf(view, sizeof view, "many bounces");
  if (result == OLX_OK) result = bench_show(b, view, OLX_LAYER_INDIRECT_DIFFUSE, shown, 2, reference, 0);
  for (uint32_t i = 0; i < 2; ++i) bench_images_free(&images[i]);
  return result;
}

olx_result run_bounces(bench *b) {
  static const uint32_t counts[] = {1, 2, 4, MANY};
  bench_table *table = FINDINGS_TABLE(
      &b->found, "bounces", "Indirect diffuse light, cornell, 4x4x4 probes (2x2x2 with --quick)", columns, plots);
  olx_scene *scene;
  olx_result result = bench_scene(b, "builtin:cornell", &scene);
  for (size_t i = 0; i < sizeof counts / sizeof *counts && result == OLX_OK; ++i) {
    if (b->options->quick && counts[i] == 2) continue;
    result = run_count(b, scene, counts[i], table);
  }
  return result;
}
