// The rows of one scene of Wang's thesis, measured in steps (wang_study_scene runs all steps of an experiment).
#ifndef OCTALUX_BENCH_WANG_ROWS_H
#define OCTALUX_BENCH_WANG_ROWS_H

#include "wang_view.h"

// A row of a table and its measurements.
typedef struct wang_measured_row {
  const wang_row *row;
  uint32_t set; // index of its field
  wang_quality quality;
  double steps, probes_tried, unresolved; // means per ray
  double ms[WANG_ROUNDS], median_ms;
  bench_images pictures; // images of the first row of its set and selector, when they are shown
} wang_measured_row;

// The rows of one scene, and the fields of their sets.
typedef struct wang_measured {
  uint32_t row_count, set_count;
  wang_measured_row rows[WANG_ROWS];
  bench_field sets[WANG_ROWS];
  bench_images *references;
} wang_measured;

// Bakes a field for each distinct set of probes of the scene's rows, with or without those of appendix A; then measures
// errors, and times, of each row.
olx_result wang_bake_sets(const wang_view *view, bool series, wang_measured *t);
olx_result wang_measure_errors(const wang_view *view, wang_measured *t, bool keep_pictures);
olx_result wang_time_rows(const wang_view *view, wang_measured *t);
// Closes the fields; what was measured of them is kept.
void wang_close_sets(wang_measured *t);

// Returns the name of a row's set of probes, such as "16 sdf + gibbs".
bench_name wang_row_name(const wang_measured_row *row);

#endif
