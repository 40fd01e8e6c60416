// What every experiment of octalux-bench is built on: scenes that may be absent, references that are path traced
// once, fields, and findings: tables and pictures that become text, JSON and a report.
#ifndef OCTALUX_BENCH_EXPERIMENT_H
#define OCTALUX_BENCH_EXPERIMENT_H

#include "bench_measure.h"
#include "findings.h"
#include "report.h"

// The options of the command line that every experiment takes.
typedef struct bench_options {
  bool all; // experiments in one run: they share what they can
  bool quick, progress, json;
  const char *folder, *images, *report; // of scenes, for pictures, for the report
  const char *only;                     // names of scenes with commas between, NULL: all
  uint32_t size[2], spp, threads;       // 0: the experiment's own
  // Options of some experiments, for Wang's thesis.
  uint32_t texels, field_spp, rounds; // TAKES_SIZES; 0: the experiment's own
  const char *sets;                   // TAKES_SETS, names with commas between; NULL: the experiment's own
  bool brief;                         // TAKES_SHORT
} bench_options;

typedef struct bench bench;

// What an experiment takes besides the options of all.
enum { TAKES_SIZES = 1, TAKES_SETS = 2, TAKES_SHORT = 4 };

// To add one, write its function, declare it in experiment_list.h, and describe it in experiments.c.
typedef struct experiment {
  const char *name;   // on the command line
  const char *source; // "McGuire et al. 2017, Table 1"
  const char *what;   // one line, for lists
  const char *note;   // what there is to know before reading its numbers
  olx_result (*run)(bench *b);
  const char *(*scene)(uint32_t index); // names for --only, NULL after the last; NULL: it runs whole
  uint32_t takes;                       // options
  bool alone;                           // takes hours, and is no part of `all`
} experiment;

extern const experiment experiments[];
extern const uint32_t experiment_count;

enum { BENCH_SCENES = 8, BENCH_SHARED = 4 };

typedef struct bench_reference_entry bench_reference_entry;

struct bench {
  const bench_options *options;
  const experiment *experiment; // that runs
  findings found;               // by it
  cJSON *section;               // of the report, NULL without one
  olx_progress progress;
  bool told; // progress is shown
  bench_folder folder;
  uint32_t fields;                   // baked so far
  bench_reference_entry *references; // of the whole run
  struct {
    const char *name;
    olx_scene *scene;
  } scenes[BENCH_SCENES]; // of this experiment
  uint32_t scene_count;
  struct {
    void *data;
    void (*release)(void *data);
  } shared[BENCH_SHARED]; // of the whole run
  uint32_t shared_count;
};

// A run of one or more experiments. False when there is no place for temporary fields.
bool bench_open(bench *b, const bench_options *options, progress_line *line);
void bench_close(bench *b);
// Run an experiment into b->found, which is to be freed, and into a section of a report, which may be NULL.
olx_result bench_run(bench *b, const experiment *e, cJSON *section);

// ---- for experiments

// Prints on standard error which step runs now.
void bench_tell(const bench *b, const char *format, ...) __attribute__((format(printf, 2, 3)));

// What several experiments of a run share: zeroed when the first of them queries it, found again by its release
// function, which runs when the run ends and frees what the data names, not the data itself. NULL when there is no
// memory.
void *bench_shared(bench *b, size_t size_bytes, void (*release)(void *data));

// "builtin:NAME", or NAME of a description in the folder of scenes. *scene is NULL when its files are not here, which
// the findings then tell. It lives until the experiment ends.
olx_result bench_scene(bench *b, const char *name, olx_scene **scene);
// Whether --quick leaves the scene out; when it does, the findings say so.
bool bench_leaves_out(bench *b, const char *name);
// Whether --only names the scene, or is not given.
bool bench_names(const bench_options *o, const char *title);
// "pillars" for "builtin:pillars".
const char *bench_scene_title(const char *name);

// Sizes and samples as the command line or --quick want them; references and pictures from fields. All of one run share
// them unless an experiment says otherwise, so that references are shared too.
olx_render_settings bench_path_settings(const bench *b);
olx_render_settings bench_field_settings(const bench *b);
uint32_t bench_bounces(const bench *b); // after direct light, of fields; references have one more
uint32_t bench_spp(const bench *b);     // camera samples a pixel of pictures from fields

// Path traced from these cameras with so many bounces; made once in a run. The run's, not the caller's.
olx_result bench_reference(bench *b, const olx_scene *scene, const olx_camera *cameras, uint32_t count,
                           const olx_render_settings *settings, uint32_t bounces, bench_images **references);

// What a field is baked with unless the experiment says otherwise: fine, or rough with --quick.
bench_bake bench_bake_settings(const bench *b, bool classic);
// Place, bake and open. Close it in any case (bench_field_close).
olx_result bench_bake_field(bench *b, const olx_scene *scene, const bench_probes *probes, const bench_bake *bake,
                            bench_field *made);
// Pictures from it, their noise independent of the references'.
olx_result bench_pictures(bench *b, const olx_scene *scene, const olx_camera *cameras, uint32_t count,
                          const bench_way *way, bench_images *images);

// How a picture differs from its reference: light, and what a viewer would see of it.
typedef struct bench_quality {
  bench_error error;
  double ssim, flip; // not numbers for the sum of both indirect layers
  float exposure;    // of the pictures that were compared
} bench_quality;
olx_result bench_compare(bench *b, bench_images *images, bench_images *references, bench_light light, uint32_t camera,
                         bench_quality *quality);

// Columns and cells of a bench_quality.
#define QUALITY_COLUMNS                                                                                                \
  {"mse", "MSE", BENCH_QUALITY, NULL, "mean squared error of light, free of noise on average"},                        \
      {"noise", "\u00b1", BENCH_SPREAD, NULL, "what noise may be off in it: at least its standard error"},             \
      {"relative_mse", "relative MSE", BENCH_QUALITY, NULL, "over the reference's mean square"},                       \
      {"bias", "bias", BENCH_QUALITY, "%", "light too much or missing, over the reference's mean"},                    \
      {"ssim", "SSIM", BENCH_QUALITY, NULL, "structural similarity of the tone-mapped pictures: 1 is equal"}, {        \
    "flip", "FLIP", BENCH_QUALITY, NULL, "mean LDR-FLIP of the tone-mapped pictures: 0 is equal"                       \
  }
#define QUALITY_CELLS(q)                                                                                               \
  NUMBER_CELL((q).error.mse), NUMBER_CELL((q).error.noise), NUMBER_CELL((q).error.relative_mse),                       \
      NUMBER_CELL((q).error.bias), NUMBER_CELL((q).ssim), NUMBER_CELL((q).flip)

// Pictures of one view for the report and for --images: several ways, then the reference, of one layer.
typedef struct bench_shown {
  const char *way;
  bench_images *images;
  uint32_t camera; // of the images
} bench_shown;
olx_result bench_show(bench *b, const char *view, olx_layer layer, const bench_shown *ways, uint32_t count,
                      bench_images *references, uint32_t reference_camera);

#endif
