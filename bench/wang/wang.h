// The experiments of Wang's thesis, chapter 5 and appendix A (docs/results.md).
#ifndef OCTALUX_BENCH_WANG_H
#define OCTALUX_BENCH_WANG_H

#include "bench_measure.h"
#include "report.h"

// One way to trace one set of probes.
typedef struct wang_row {
  bench_probes probes;
  olx_tracer tracer;
  olx_select select;
  const char *shown; // where in the thesis; NULL: ours
  double ms, mse;    // as published; 0: not
} wang_row;

// A size of grid, the shapes it may have, and what is to do as well with fewer probes.
typedef struct wang_size {
  uint32_t probes;
  const uint32_t (*shapes)[3];
  uint32_t shape_count;
} wang_size;

typedef struct wang_scene {
  const char *name;        // as --scene says it
  const char *description; // in the folder of descriptions
  const wang_row *rows;
  uint32_t row_count;
  const wang_size *sizes;
  uint32_t size_count;
} wang_scene;

enum { WANG_SCENES = 3 };
extern const wang_scene wang_scenes[WANG_SCENES];

// What the command line may change.
typedef struct wang_options {
  uint32_t scene; // of wang_scenes; WANG_SCENES: all
  const char *folder, *images, *sets;
  uint32_t size[2], spp, field_spp, rounds, texels, threads;
  bool quick, brief, progress, json;
} wang_options;

// A scene with its references, while its rows are measured.
typedef struct wang_run {
  const wang_options *options;
  const wang_scene *experiment;
  olx_scene *scene;
  bench_bake bake;
  bench_folder folder;
  olx_progress progress;
  bool told; // progress is shown
  bench_images references;
} wang_run;

// What a set of probes gives.
typedef struct wang_quality {
  bench_error glossy, beauty, glossy_camera[BENCH_CAMERAS];
  olx_render_stats stats;
} wang_quality;

// Prints on standard error which step runs now.
void wang_tell(const wang_run *run, const char *what, const char *name);
// The probes as the command line's --texels wants them.
bench_probes wang_probes(const wang_run *run, const bench_probes *probes);
// Render the scene's cameras from a field and compare. `kept` receives the pictures, which are the caller's to free; NULL.
olx_result wang_measure(wang_run *run, const olx_field *field, olx_tracer tracer, olx_select select,
                        const char *image_name, wang_quality *quality, bench_images *kept);
// What comes before any measuring: how fields are baked; the references, to be freed with bench_images_free.
olx_result wang_prepare(wang_run *run);
olx_result wang_load_scene(wang_run *run);
// Sizes and samples that were not given.
void wang_resolve(wang_options *o);

enum { WANG_ROWS = 48, WANG_ROUNDS = 1000 };

// A row, and what was found.
typedef struct wang_measured_row {
  const wang_row *row;
  uint32_t set; // of the fields
  wang_quality quality;
  double steps, probes_tried, unresolved; // a ray
  double ms[WANG_ROUNDS], median_ms;
  bench_images pictures; // kept only when asked for
} wang_measured_row;

typedef struct wang_measured {
  uint32_t row_count, set_count;
  wang_measured_row rows[WANG_ROWS];
  bench_field sets[WANG_ROWS];
} wang_measured;

// "texel", "two-level", "hiz".
const char *wang_tracer_name(olx_tracer tracer);
// A field for each different set of probes that the scene's rows name; then errors, and times, of each row.
olx_result wang_bake_sets(wang_run *run, wang_measured *t);
olx_result wang_measure_errors(wang_run *run, wang_measured *t, bool keep_pictures);
olx_result wang_time_rows(wang_run *run, wang_measured *t);
void wang_close_sets(wang_measured *t);
void wang_add_error(cJSON *object, const char *key, const bench_error *error);

// The experiments: each adds its findings to the JSON object of a scene, and prints its table unless JSON is asked for.
olx_result wang_run_tables(wang_run *run, cJSON *object);
olx_result wang_run_counts(wang_run *run, cJSON *object);

#endif
