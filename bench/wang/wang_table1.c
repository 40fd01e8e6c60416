// Repeats Table 5.1 of Wang's thesis: the time of the glossy pass.
#include "experiment_list.h"
#include "wang_study.h"

#include <math.h>

static const bench_column columns[] = {
    {"scene", "scene", BENCH_NAME, NULL, NULL},
    {"set", "probes", BENCH_NAME, NULL, NULL},
    {"tracer", "tracer", BENCH_NAME, NULL, "the original algorithm is two-level"},
    {"select", "selector", BENCH_NAME, NULL, NULL},
    {"ms", "glossy pass", BENCH_TIME, "ms", "processor time of one core, one ray a pixel, mean over the cameras"},
    {"speedup", "times as fast", BENCH_TIME, NULL, "as the scene's first row"},
    {"published_ms", "published", BENCH_PUBLISHED, "ms", "Table 5.1: GTX 1060, 1900 x 1080"},
    {"published_speedup", "times as fast", BENCH_PUBLISHED, NULL, "by Table 5.1"},
    {"steps", "steps a ray", BENCH_QUALITY, NULL, "texels whose distance is read"},
    {"tried", "probes a ray", BENCH_QUALITY, NULL, NULL},
    {"unresolved", "unresolved", BENCH_QUALITY, "%", "rays that no probe could answer"},
};
static const bench_plot plots[] = {{.caption = "Time of the glossy pass", .y = "ms"}};

static void add_scene(bench *b, bench_table *table, uint32_t scene, const wang_measured *t) {
  for (uint32_t i = 0; i < t->row_count; ++i) {
    const wang_measured_row *row = &t->rows[i];
    const double published = row->row->ms > 0.0 ? row->row->ms : NAN;
    FINDINGS_ROW(&b->found, table, TEXT_CELL(wang_scenes[scene].name), TEXT_CELL(wang_row_name(row).text),
                 TEXT_CELL(wang_tracer_name(row->row->tracer)), TEXT_CELL(olx_select_name(row->row->select)),
                 NUMBER_CELL(row->median_ms), NUMBER_CELL(t->rows[0].median_ms / row->median_ms),
                 NUMBER_CELL(published), NUMBER_CELL(t->rows[0].row->ms / published), NUMBER_CELL(row->steps),
                 NUMBER_CELL(row->probes_tried), NUMBER_CELL(row->unresolved));
  }
}

olx_result run_wang_table1(bench *b) {
  bench_table *table =
      FINDINGS_TABLE(&b->found, "times", "Glossy pass, all rows in turns, median of the rounds", columns, plots);
  for (uint32_t i = 0; i < WANG_SCENES; ++i) {
    wang_measured *t;
    const olx_result result = wang_study_scene(b, i, WANG_TIMES, false, &t);
    if (result != OLX_OK) return result;
    if (t) add_scene(b, table, i, t);
  }
  return OLX_OK;
}
