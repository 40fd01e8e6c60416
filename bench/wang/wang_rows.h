// The rows of one scene of Wang's thesis, measured step by step (wang_study_scene does all that an experiment needs).
#ifndef OCTALUX_BENCH_WANG_ROWS_H
#define OCTALUX_BENCH_WANG_ROWS_H

#include "wang_view.h"

// A row, and what was found.
typedef struct wang_measured_row {
  const wang_row *row;
  uint32_t set; // of the fields
  wang_quality quality;
  double steps, probes_tried, unresolved; // a ray
  double ms[WANG_ROUNDS], median_ms;
  bench_images pictures; // of the first row of its set and selector, when there is someone to show them to
} wang_measured_row;

// The rows of one scene, and the fields of their sets.
typedef struct wang_measured {
  uint32_t row_count, set_count;
  wang_measured_row rows[WANG_ROWS];
  bench_field sets[WANG_ROWS];
  bench_images *references;
} wang_measured;

// A field for each different set of probes that the scene's rows name, with or without those of appendix A; then
// errors, and times, of each row.
olx_result wang_bake_sets(const wang_view *view, bool series, wang_measured *t);
olx_result wang_measure_errors(const wang_view *view, wang_measured *t, bool keep_pictures);
olx_result wang_time_rows(const wang_view *view, wang_measured *t);
// What is known of the fields stays.
void wang_close_sets(wang_measured *t);

// A row's set of probes: "16 sdf + gibbs".
bench_name wang_row_name(const wang_measured_row *row);

#endif
