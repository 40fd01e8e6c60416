// The basis of all experiments of octalux-bench: scenes that may be absent, references that are path traced once,
// fields, and findings: tables and images that are written as text, JSON and a report.
#ifndef OCTALUX_BENCH_EXPERIMENT_H
#define OCTALUX_BENCH_EXPERIMENT_H

#include "bench_measure.h"
#include "findings.h"
#include "report.h"

// The options of the command line that every experiment takes.
typedef struct bench_options {
  bool several; // more than one experiment runs: data that they share is computed once
  bool quick, progress, json;
  const char *folder, *images, *report; // folders of scenes and of images, file of the report
  const char *only;                     // names of scenes, separated by commas; NULL: all
  uint32_t size[2], spp, threads;       // 0: the experiment's default
  // Options of some experiments, for Wang's thesis.
  uint32_t texels, field_spp, rounds; // options of TAKES_SIZES; 0: the experiment's default
  const char *sets;                   // option of TAKES_SETS: names separated by commas; NULL: the experiment's default
  bool brief;                         // option of TAKES_SHORT
} bench_options;

typedef struct bench bench;

// Options that an experiment takes besides the common ones.
enum { TAKES_SIZES = 1, TAKES_SETS = 2, TAKES_SHORT = 4 };

// An experiment. To add one, write its function, declare it in experiment_list.h, and describe it in experiments.c.
typedef struct experiment {
  const char *name;   // on the command line
  const char *source; // "McGuire et al. 2017, Table 1"
  const char *what;   // one line, for lists
  const char *note;   // explanation to read before its numbers
  olx_result (*run)(bench *b);
  const char *(*scene)(uint32_t index); // names for --only, NULL after the last; NULL: the experiment has no parts
  const char *(*set)(uint32_t index);   // names for --probes, NULL after the last; NULL: any, where it takes them
  uint32_t takes;                       // options that it takes
  bool alone;                           // takes hours, and is not part of `all`
} experiment;

extern const experiment experiments[];
extern const uint32_t experiment_count;

enum { BENCH_SCENES = 8, BENCH_SHARED = 4 };

typedef struct bench_reference_entry bench_reference_entry;

struct bench {
  const bench_options *options;
  const experiment *experiment; // the running experiment
  findings found;               // results of the running experiment
  cJSON *section;               // section of the report for the experiment, or NULL
  olx_progress progress;
  bool told; // show progress
  bench_folder folder;
  uint32_t fields;                   // number of fields baked so far
  bench_reference_entry *references; // references of the whole run
  struct {
    const char *name;
    olx_scene *scene;
  } scenes[BENCH_SCENES]; // scenes of the running experiment
  uint32_t scene_count;
  struct {
    void *data;
    void (*release)(void *data);
  } shared[BENCH_SHARED]; // data of the whole run
  uint32_t shared_count;
};

// Begins a run of one or more experiments. Returns false when a folder for temporary fields cannot be created.
bool bench_open(bench *b, const bench_options *options, progress_line *line);
void bench_close(bench *b);
// Runs an experiment into b->found, which the caller frees, and into a section of a report, which may be NULL.
olx_result bench_run(bench *b, const experiment *e, cJSON *section);

// ---- For experiments

// Prints the current step on standard error.
void bench_progress(const bench *b, const char *format, ...) __attribute__((format(printf, 2, 3)));

// Returns data that several experiments of a run share, identified by its release function: zeroed on first use. When
// the run ends, `release` frees what the data refers to, but not the data itself. Returns NULL when memory runs out.
void *bench_shared(bench *b, size_t size_bytes, void (*release)(void *data));

// Loads "builtin:NAME", or the description NAME in the folder of scenes. *scene is NULL when its files are missing,
// which the findings then report. The scene lives until the experiment ends.
olx_result bench_scene(bench *b, const char *name, olx_scene **scene);
// Returns whether --quick skips the scene; the findings then report it.
bool bench_leaves_out(bench *b, const char *name);
// Returns whether a name is one of those in a text that separates them by commas.
bool bench_listed(const char *names, const char *name);
// Returns whether --only names the scene, or is not given.
bool bench_names(const bench_options *o, const char *title);
// Returns the title of a scene, such as "pillars" for "builtin:pillars".
const char *bench_scene_title(const char *name);

// Returns settings of references and of images from fields, with sizes and samples by the command line or --quick. All
// experiments of a run use these by default, so that references are shared.
olx_render_settings bench_path_settings(const bench *b);
olx_render_settings bench_field_settings(const bench *b);
// Returns those of fields on grids with rays as McGuire et al. trace them: through the probes of cages.
olx_render_settings bench_cage_settings(const bench *b);
uint32_t bench_bounces(const bench *b); // bounces after direct light, of fields; references have one more
uint32_t bench_spp(const bench *b);     // camera samples per pixel of images from fields

// Path traces a reference from these cameras with this many bounces, once per run, which owns it.
olx_result bench_reference(bench *b, const olx_scene *scene, const olx_camera *cameras, uint32_t count,
                           const olx_render_settings *settings, uint32_t bounces, bench_images **references);

// Returns default settings for baking a field: fine, or rough with --quick.
bench_bake bench_bake_settings(const bench *b, bool classic);
// Places, bakes and opens a field. Where bake->noise is 0 the bound is BENCH_MODEL_NOISE in models of descriptions, and
// the default in built-in scenes. The caller closes the field by bench_field_close, also after a failure.
olx_result bench_bake_field(bench *b, const olx_scene *scene, const bench_probes *probes, const bench_bake *bake,
                            bench_field *made);
// Renders images from a field, with noise independent of the references'.
olx_result bench_pictures(bench *b, const olx_scene *scene, const olx_camera *cameras, uint32_t count,
                          const bench_way *way, bench_images *images);

// The difference of an image from its reference: errors of light, and perceptual metrics.
typedef struct bench_quality {
  bench_error error;
  double ssim, flip; // NaN for the sum of both indirect layers
  float exposure;    // exposure of the compared images
} bench_quality;
olx_result bench_compare(bench *b, bench_images *images, bench_images *references, bench_light light, uint32_t camera,
                         bench_quality *quality);

// Writes the cells of a difference, in the order of its columns.
void bench_quality_cells(const bench_quality *quality, bench_cell cells[BENCH_DIFFERENCE_COLUMNS]);

// Images of one view for the report and for --images: several methods, then the reference, of one layer.
typedef struct bench_shown {
  const char *way;
  bench_images *images;
  uint32_t camera; // index of the camera in the images
} bench_shown;
olx_result bench_show(bench *b, const char *view, olx_layer layer, const bench_shown *ways, uint32_t count,
                      bench_images *references, uint32_t reference_camera);

#endif
