// Measures all sets of probes of Wang's thesis, those of its appendix among them, with the thesis's maps: times, errors
// and memory.
#include "experiment_list.h"
#include "wang_study.h"

#include <math.h>

static const bench_column columns[] = {
    {"scene", "scene", BENCH_NAME, NULL, NULL},
    {"set", "probes", BENCH_NAME, NULL, NULL},
    {"tracer", "tracer", BENCH_NAME, NULL, "the original algorithm is two-level"},
    {"select", "selector", BENCH_NAME, NULL, NULL},
    {"shown", "shown in", BENCH_NAME, NULL, "where in the thesis"},
    {"ms", "glossy pass", BENCH_TIME, "ms", "processor time of one core, one ray a pixel, mean over the cameras"},
    {"speedup", "times as fast", BENCH_TIME, NULL, "as the scene's first row"},
    {"published_speedup", "published", BENCH_PUBLISHED, NULL, "times as fast, by Table 5.1"},
    {"steps", "steps a ray", BENCH_QUALITY, NULL, "texels whose distance is read"},
    {"tried", "probes a ray", BENCH_QUALITY, NULL, NULL},
    {"unresolved", "unresolved", BENCH_QUALITY, "%", "rays that no probe could answer"},
    {"glossy_mse", "glossy MSE", BENCH_QUALITY, NULL, "against one bounce path traced, mean over the cameras"},
    {"noise", "\u00b1", BENCH_SPREAD, NULL, "what noise may be off in it: at least its standard error"},
    {"glossy_relative_mse", "relative MSE", BENCH_QUALITY, NULL, NULL},
    {"final_mse", "final MSE", BENCH_QUALITY, NULL, "of all indirect light"},
    {"published_mse", "published", BENCH_PUBLISHED, NULL, "MSE in the figures' captions"},
};

static const bench_column memory_columns[] = {
    {"scene", "scene", BENCH_NAME, NULL, NULL},
    {"set", "probes", BENCH_NAME, NULL, NULL},
    {"count", "count", BENCH_COUNT, NULL, NULL},
    {"geometry", "geometry", BENCH_COUNT, "MiB", "planes, or distances and normals, with the pyramid"},
    {"light", "light", BENCH_COUNT, "MiB", "with material"},
    {"texel_bytes", "a texel", BENCH_QUALITY, "bytes", "of both"},
    {"irradiance", "irradiance", BENCH_COUNT, "MiB", "with moments"},
    {"maps", "all maps", BENCH_COUNT, "MiB", NULL},
    {"voronoi", "voronoi", BENCH_QUALITY, "MiB", NULL},
    {"octree", "octree", BENCH_QUALITY, "MiB", NULL},
    {"bricks", "bricks", BENCH_QUALITY, "MiB", NULL},
    {"place_s", "placing", BENCH_TIME, "s", NULL},
    {"bake_s", "bake", BENCH_TIME, "s", NULL},
};

static const double MIB = 1048576.0;

static double or_none(double value) { return value > 0.0 ? value : NAN; }

static void add_row(bench *b, bench_table *table, const char *scene, const wang_measured *t,
                    const wang_measured_row *row) {
  const bench_error *glossy = &row->quality.glossy;
  FINDINGS_ROW(&b->found, table, TEXT_CELL(scene), TEXT_CELL(wang_row_name(row).text),
               TEXT_CELL(wang_tracer_name(row->row->tracer)), TEXT_CELL(olx_select_name(row->row->select)),
               TEXT_CELL(row->row->shown ? row->row->shown : ""), NUMBER_CELL(row->median_ms),
               NUMBER_CELL(t->rows[0].median_ms / row->median_ms),
               NUMBER_CELL(or_none(t->rows[0].row->ms) / or_none(row->row->ms)), NUMBER_CELL(row->steps),
               NUMBER_CELL(row->probes_tried), NUMBER_CELL(row->unresolved), NUMBER_CELL(glossy->mse),
               NUMBER_CELL(glossy->noise), NUMBER_CELL(glossy->relative_mse), NUMBER_CELL(row->quality.beauty.mse),
               NUMBER_CELL(or_none(row->row->mse)));
}

static void add_memory(bench *b, bench_table *table, const char *scene, const wang_measured_row *row,
                       const bench_field *set) {
  const olx_field_info *info = &set->info;
  FINDINGS_ROW(&b->found, table, TEXT_CELL(scene), TEXT_CELL(wang_row_name(row).text), NUMBER_CELL(info->probes.count),
               NUMBER_CELL((double)bench_geometry_bytes(info) / MIB),
               NUMBER_CELL((double)bench_light_bytes(info) / MIB), NUMBER_CELL(bench_texel_bytes(info)),
               NUMBER_CELL((double)(info->bytes.irradiance + info->bytes.moments) / MIB),
               NUMBER_CELL((double)(info->bytes.file - info->bytes.selectors) / MIB),
               NUMBER_CELL((double)info->bytes.select[OLX_SELECT_VORONOI] / MIB),
               NUMBER_CELL((double)info->bytes.select[OLX_SELECT_OCTREE] / MIB),
               NUMBER_CELL((double)info->bytes.select[OLX_SELECT_BRICKS] / MIB), NUMBER_CELL(set->place_seconds),
               NUMBER_CELL(set->bake_seconds));
}

// Shows the final light and the glossy layer of every row that has pictures of its own.
static olx_result show(bench *b, uint32_t scene, const wang_measured *t) {
  uint32_t rows[WANG_ROWS], count = 0;
  for (uint32_t i = 0; i < t->row_count; ++i) {
    if (t->rows[i].pictures.cameras) rows[count++] = i;
  }
  const olx_result result = wang_study_show(b, scene, rows, count, OLX_LAYER_INDIRECT_GLOSSY);
  return result == OLX_OK ? wang_study_show(b, scene, rows, count, OLX_LAYER_BEAUTY) : result;
}

olx_result run_wang(bench *b) {
  bench_table *table = findings_table(&b->found, "rows", "Glossy pass, all rows in turns, and errors", columns,
                                      sizeof columns / sizeof *columns, NULL, 0);
  bench_table *memory = findings_table(&b->found, "memory", "Memory of the fields", memory_columns,
                                       sizeof memory_columns / sizeof *memory_columns, NULL, 0);
  for (uint32_t i = 0; i < WANG_SCENES; ++i) {
    wang_measured *t;
    olx_result result = wang_study_scene(b, i, WANG_ERRORS | WANG_TIMES, !b->options->brief, &t);
    if (result == OLX_OK && t) result = show(b, i, t);
    if (result != OLX_OK) return result;
    for (uint32_t r = 0, listed = 0; t && r < t->row_count; ++r) {
      const wang_measured_row *row = &t->rows[r];
      add_row(b, table, wang_scenes[i].name, t, row);
      if (row->set < listed) continue;
      add_memory(b, memory, wang_scenes[i].name, row, &t->sets[row->set]);
      listed = row->set + 1;
    }
  }
  return OLX_OK;
}
