// Fields of one scene that differ in the number of their probes or in their texels, side by side.
#ifndef OCTALUX_BENCH_FIELD_SWEEP_H
#define OCTALUX_BENCH_FIELD_SWEEP_H

#include "experiment.h"

typedef struct sweep_step {
  uint32_t grid[3], texels;
} sweep_step;

typedef struct sweep_scene {
  const char *scene, *camera; // NULL: the first
  const sweep_step *steps;
  uint32_t step_count;
} sweep_scene;

enum { SWEEP_STEPS = 8 };

// Bakes, renders and compares each step; rows go to a table, and pictures of `layer` to the report. `plots` show
// columns of the table.
olx_result run_sweep(bench *b, const sweep_scene *scenes, uint32_t count, olx_layer layer, const char *caption,
                     const bench_plot *plots, uint32_t plot_count);

#endif
