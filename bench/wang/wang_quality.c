// Repeats sections 5.1.1, 5.1.2 and 5.2 of Wang's thesis: sets of probes of equal quality, of equal count, and of equal
// time.
#include "experiment_list.h"
#include "wang_study.h"

#include <math.h>
#include <string.h>

enum { MOST_SHOWN = 8 };

static const bench_column columns[] = {
    {"comparison", "comparison", BENCH_NAME, NULL, NULL},
    {"scene", "scene", BENCH_NAME, NULL, NULL},
    {"set", "probes", BENCH_NAME, NULL, NULL},
    {"select", "selector", BENCH_NAME, NULL, NULL},
    {"glossy_mse", "glossy MSE", BENCH_QUALITY, NULL, "against one bounce path traced, mean over the cameras"},
    {"noise", "\u00b1", BENCH_SPREAD, NULL, "what noise may be off in it: at least its standard error"},
    {"glossy_relative_mse", "relative MSE", BENCH_QUALITY, NULL, NULL},
    {"over_grid", "over the grid", BENCH_QUALITY, NULL, "glossy MSE over that of the comparison's grid"},
    {"final_mse", "final MSE", BENCH_QUALITY, NULL, "of all indirect light"},
    {"published_mse", "published", BENCH_PUBLISHED, NULL, "MSE in the figures' captions"},
    {"published_over", "over the grid", BENCH_PUBLISHED, NULL, NULL},
    {"ms", "glossy pass", BENCH_TIME, "ms", "processor time of one core"},
    {"published_ms", "published", BENCH_PUBLISHED, "ms", NULL},
};
static const bench_plot plots[] = {{.caption = "Glossy error over that of the grid", .y = "over_grid"}};

typedef struct contest {
  const char *name;
  uint32_t scene;
  const char *grid, *placed;
  double grid_mse, placed_mse, grid_ms, placed_ms; // as published; 0: not published
} contest;

static const contest contests[] = {
    {"equal quality, Fig. 5.1", 0, "2x2x2 grid", "7 sdf + gibbs", 0, 0, 11.3, 6.1},
    {"equal quality, Fig. 5.2", 1, "4x2x4 grid", "16 sdf + gibbs", 2.70e-3, 2.78e-3, 27.7, 17.3},
    {"equal quality, Fig. 5.4", 2, "8x4x4 grid", "64 medial + gibbs", 1.05e-2, 1.10e-2, 30.0, 23.2},
    {"equal count, Fig. 5.5", 1, "2x2x4 grid", "16 sdf + gibbs", 0, 0, 32.5, 17.3},
    {"equal count, Fig. 5.6", 2, "6x3x3 grid", "54 medial + gibbs", 4.14e-2, 1.27e-2, 24.1, 19.0},
    {"equal time, Fig. 5.8", 1, "4x4x4 grid", "79 medial + gibbs", 0, 0, 0, 0},
    {"equal time, Fig. 5.9", 2, "3x3x3 grid", "54 medial + gibbs", 2.41e-2, 1.27e-2, 20.0, 20.6},
};

static double or_none(double value) { return value > 0.0 ? value : NAN; }

// Finds the row of a set that the thesis shows: with the selector cage or octree.
static uint32_t find_row(const wang_measured *t, const char *set) {
  for (uint32_t r = 0; r < t->row_count; ++r) {
    const olx_select select = t->rows[r].row->select;
    const bool theirs = select == OLX_SELECT_CAGE || select == OLX_SELECT_OCTREE;
    if (theirs && strcmp(wang_row_name(&t->rows[r]).text, set) == 0) return r;
  }
  return UINT32_MAX;
}

static void add_row(bench *b, bench_table *table, const contest *c, const wang_measured_row *row,
                    const wang_measured_row *grid) {
  const bool first = row == grid;
  const bench_error *glossy = &row->quality.glossy;
  FINDINGS_ROW(&b->found, table, TEXT_CELL(c->name), TEXT_CELL(wang_scenes[c->scene].name),
               TEXT_CELL(wang_row_name(row).text), TEXT_CELL(olx_select_name(row->row->select)),
               NUMBER_CELL(glossy->mse), NUMBER_CELL(glossy->noise), NUMBER_CELL(glossy->relative_mse),
               NUMBER_CELL(glossy->mse / grid->quality.glossy.mse), NUMBER_CELL(row->quality.beauty.mse),
               NUMBER_CELL(or_none(first ? c->grid_mse : c->placed_mse)),
               NUMBER_CELL(c->grid_mse > 0.0 ? (first ? 1.0 : c->placed_mse / c->grid_mse) : NAN),
               NUMBER_CELL(row->median_ms), NUMBER_CELL(or_none(first ? c->grid_ms : c->placed_ms)));
}

static void add_once(uint32_t *list, uint32_t *count, uint32_t row) {
  for (uint32_t i = 0; i < *count; ++i) {
    if (list[i] == row) return;
  }
  if (*count < MOST_SHOWN) list[(*count)++] = row;
}

olx_result run_wang_quality(bench *b) {
  bench_table *table =
      FINDINGS_TABLE(&b->found, "quality", "Grids by the cage against placed probes by the octree", columns, plots);
  for (uint32_t i = 0; i < WANG_SCENES; ++i) {
    wang_measured *t;
    olx_result result = wang_study_scene(b, i, WANG_ERRORS | WANG_TIMES, false, &t);
    if (result != OLX_OK) return result;
    uint32_t shown[MOST_SHOWN], count = 0;
    for (size_t k = 0; t && k < sizeof contests / sizeof *contests; ++k) {
      const contest *c = &contests[k];
      if (c->scene != i) continue;
      const uint32_t grid = find_row(t, c->grid), placed = find_row(t, c->placed);
      if (grid == UINT32_MAX || placed == UINT32_MAX) continue;
      add_row(b, table, c, &t->rows[grid], &t->rows[grid]);
      add_row(b, table, c, &t->rows[placed], &t->rows[grid]);
      add_once(shown, &count, grid);
      add_once(shown, &count, placed);
    }
    if (count > 0) result = wang_study_show(b, i, shown, count, OLX_LAYER_INDIRECT_GLOSSY);
    if (result != OLX_OK) return result;
  }
  return OLX_OK;
}
