// The comparison of Wang's thesis, chapter 5 and appendix A (docs/results.md): sets of probes on three scenes.
#ifndef OCTALUX_BENCH_WANG_H
#define OCTALUX_BENCH_WANG_H

#include "bench_measure.h"

// A set of probes and a method of tracing it.
typedef struct wang_row {
  bench_probes probes;
  olx_tracer tracer;
  olx_select select;
  const char *shown; // figure or table of the thesis that shows the row; NULL: an addition
  double ms, mse;    // as published; 0: not published
} wang_row;

// A size of grid, its possible shapes, and the sets that should match it with fewer probes.
typedef struct wang_size {
  uint32_t probes;
  const uint32_t (*shapes)[3];
  uint32_t shape_count;
} wang_size;

typedef struct wang_scene {
  const char *name;        // name in tables and for --only
  const char *description; // name in the folder of descriptions
  const wang_row *rows;
  uint32_t row_count;
  const wang_size *sizes;
  uint32_t size_count;
} wang_scene;

enum { WANG_SCENES = 3, WANG_ROWS = 48, WANG_ROUNDS = 1000 };
extern const wang_scene wang_scenes[WANG_SCENES];

// Returns the name of a scene for --only, NULL after the last.
const char *wang_scene_name(uint32_t index);

#endif
