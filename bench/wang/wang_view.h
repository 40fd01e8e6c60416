// An open scene of Wang's thesis with its references, and comparisons of images from a field with them.
#ifndef OCTALUX_BENCH_WANG_VIEW_H
#define OCTALUX_BENCH_WANG_VIEW_H

#include "experiment.h"
#include "wang.h"

// A scene's view. Light has one bounce, as in Wang's thesis: it is reflected once before it reaches what the camera
// sees.
typedef struct wang_view {
  bench *b;
  const wang_scene *plan;
  olx_scene *scene; // NULL: skipped, as the findings report
  bench_bake bake;
  bench_images *references;
} wang_view;
olx_result wang_open(bench *b, uint32_t scene, wang_view *view);
// Returns whether the experiment skips the scene, because --only does not name it or because of --quick, which the
// findings report.
bool wang_leaves_out(bench *b, uint32_t scene);

// Returns settings for images with the size and the samples of the run.
olx_render_settings wang_picture(const bench *b, olx_method method);
// Returns the probes with map sizes by --texels, which replaces 512 texels.
bench_probes wang_probes(const bench *b, const bench_probes *probes);
uint32_t wang_rounds(const bench *b);

// The results of a set of probes.
typedef struct wang_quality {
  bench_error glossy, beauty, glossy_camera[BENCH_CAMERAS];
} wang_quality;
// Renders the scene's cameras from a field and compares. `pictures` receives the images, which must be freed, also
// after a failure.
olx_result wang_compare(const wang_view *view, const olx_field *field, olx_tracer tracer, olx_select select,
                        const char *name, wang_quality *quality, bench_images *pictures);

#endif
