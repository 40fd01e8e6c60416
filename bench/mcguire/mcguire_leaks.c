// Repeats Figures 10 to 13 of McGuire et al. 2017: light that leaks when irradiance probes are interpolated without
// visibility.
#include "experiment_list.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { FRAMES = 64, MOST_WAYS = 6 };

typedef struct figure {
  const char *name, *scene, *camera;
  uint32_t grid[3];
  bool traced; // also compares light of rays through the light field probes
  bool buried; // some of its probes are inside geometry
} figure;

static const figure figures[] = {
    {"Fig. 10", "builtin:pillars", "corner", {3, 2, 3}, false, true},
    {"Fig. 11", "builtin:labyrinth", "chamber", {3, 2, 3}, true, false},
    {"Fig. 12", "sponza", "aisle", {8, 2, 4}, false, false},
    {"Fig. 13", "builtin:labyrinth", "door", {3, 2, 3}, true, false},
};
enum { FIGURES = sizeof figures / sizeof *figures };

static const bench_column columns[] = {
    {"figure", "figure", BENCH_NAME, NULL, NULL},
    {"scene", "scene", BENCH_NAME, NULL, NULL},
    {"way", "way", BENCH_NAME, NULL, NULL},
    {.kind = BENCH_DIFFERENCE},
    {"over_classic", "over classic", BENCH_QUALITY, NULL, "its MSE over that of the method it replaces"},
    {"ms", "diffuse pass", BENCH_TIME, "ms", "processor time of one frame, with denoising"},
    {"published_ms", "published", BENCH_PUBLISHED, "ms", "GTX 1080, 1920 x 1080"},
};

static const bench_plot plots[] = {
    {.caption = "Error of the indirect light", .y = "relative_mse"},
};

// Lists the methods of a figure, with the one to be replaced last.
static uint32_t list_ways(const bench *b, const figure *f, const olx_field *field, bench_way ways[MOST_WAYS]) {
  uint32_t count = 0;
  olx_render_settings settings = bench_cage_settings(b);
  settings.spp = 1;
  settings.centered = true;
  ways[count++] = (bench_way){.name = "field", .field = field, .settings = settings};
  olx_render_settings stored = settings;
  stored.diffuse = OLX_DIFFUSE_SURFACE;
  ways[count++] = (bench_way){.name = "at surfaces", .field = field, .settings = stored};
  if (f->traced) {
    olx_render_settings traced = settings;
    traced.diffuse = OLX_DIFFUSE_TRACED;
    traced.denoise = olx_denoise_settings_none();
    ways[count++] = (bench_way){.name = "one ray a pixel", .field = field, .settings = traced, .frames = 1};
    traced.denoise = olx_denoise_settings_default();
    ways[count++] = (bench_way){.name = "denoised", .field = field, .settings = traced, .frames = FRAMES};
  }
  olx_render_settings plain = settings;
  plain.sample.visibility = OLX_VISIBILITY_NONE;
  ways[count++] = (bench_way){.name = "no visibility", .field = field, .settings = plain};
  settings.method = OLX_METHOD_CLASSIC;
  if (f->buried)
    ways[count++] = (bench_way){.name = "classic, free probes alone", .field = field, .settings = settings};
  settings.sample.keep_buried = true;
  ways[count++] = (bench_way){.name = "classic", .field = field, .settings = settings};
  return count;
}

static double published_ms(const char *figure_name, const char *way) {
  if (strcmp(figure_name, "Fig. 11") != 0) return NAN;
  return strcmp(way, "field") == 0 ? 0.2 : strcmp(way, "denoised") == 0 ? 13.0 : NAN;
}

static olx_result measure(bench *b, const figure *f, const olx_scene *scene, const olx_field *field,
                          bench_table *table) {
  olx_camera camera;
  olx_result result = olx_scene_find_camera(scene, f->camera, &camera);
  if (result != OLX_OK) return result;
  olx_render_settings settings = bench_path_settings(b);
  settings.centered = true;
  bench_images *reference, images[MOST_WAYS] = {0};
  bench_way ways[MOST_WAYS];
  bench_quality quality[MOST_WAYS];
  bench_shown shown[MOST_WAYS];
  const uint32_t count = list_ways(b, f, field, ways);
  result = bench_reference(b, scene, &camera, 1, &settings, bench_bounces(b) + 1, &reference);
  for (uint32_t i = 0; i < count && result == OLX_OK; ++i) {
    shown[i] = (bench_shown){.way = ways[i].name, .images = &images[i]};
    result = bench_pictures(b, scene, &camera, 1, &ways[i], &images[i]);
    if (result == OLX_OK) result = bench_compare(b, &images[i], reference, BENCH_DIFFUSE, 0, &quality[i]);
  }
  for (uint32_t i = 0; i < count && result == OLX_OK; ++i) {
    const olx_render_stats *stats = &images[i].stats;
    const double frames = 2.0 * (ways[i].frames ? ways[i].frames : 1);
    bench_cell cells[BENCH_DIFFERENCE_COLUMNS];
    bench_quality_cells(&quality[i], cells);
    FINDINGS_ROW(&b->found, table, TEXT_CELL(f->name), TEXT_CELL(bench_scene_title(f->scene)), TEXT_CELL(ways[i].name),
                 DIFFERENCE_CELLS(cells), NUMBER_CELL(quality[i].error.mse / quality[count - 1].error.mse),
                 NUMBER_CELL(1e3 * (stats->diffuse_seconds + stats->denoise_seconds) / frames),
                 NUMBER_CELL(published_ms(f->name, ways[i].name)));
  }
  char view[96];
  snprintf(view, sizeof view, "%s: %s, %s", f->name, bench_scene_title(f->scene), camera.name);
  if (result == OLX_OK) result = bench_show(b, view, OLX_LAYER_INDIRECT_DIFFUSE, shown, count, reference, 0);
  for (uint32_t i = 0; i < count; ++i) bench_images_free(&images[i]);
  return result;
}

static olx_result run_figure(bench *b, const figure *f, bench_table *table) {
  olx_scene *scene;
  olx_result result = bench_scene(b, f->scene, &scene);
  if (result != OLX_OK || !scene) return result;
  const bool quick = b->options->quick;
  const bench_probes probes = {.grid = {f->grid[0], f->grid[1], f->grid[2]}, .texels = quick ? 64 : 256};
  bench_bake bake = bench_bake_settings(b, true);
  result = olx_scene_probe_grid(scene, probes.grid, &bake.irradiance_grid);
  if (result != OLX_OK) return result;
  bench_field made;
  result = bench_bake_field(b, scene, &probes, &bake, &made);
  if (result == OLX_OK) result = measure(b, f, scene, made.field, table);
  bench_field_close(&made);
  return result;
}

olx_result run_mcguire_leaks(bench *b) {
  bench_table *table =
      FINDINGS_TABLE(&b->found, "figures", "Indirect diffuse light against the path tracer", columns, plots);
  for (uint32_t i = 0; i < FIGURES; ++i) {
    if (bench_leaves_out(b, figures[i].scene)) continue;
    const olx_result result = run_figure(b, &figures[i], table);
    if (result != OLX_OK) return result;
  }
  return OLX_OK;
}
