// A scene of Wang's thesis that is open, with its references, and how pictures from a field compare with them.
#ifndef OCTALUX_BENCH_WANG_VIEW_H
#define OCTALUX_BENCH_WANG_VIEW_H

#include "experiment.h"
#include "wang.h"

// Light has one bounce, as Wang has it: it was reflected once before it reaches what the camera sees.
typedef struct wang_view {
  bench *b;
  const wang_scene *plan;
  olx_scene *scene; // NULL: it is left out, which the findings tell
  bench_bake bake;
  bench_images *references;
} wang_view;
olx_result wang_open(bench *b, uint32_t scene, wang_view *view);
// Whether the experiment leaves the scene out, because --only does not name it or because of --quick, which the
// findings tell.
bool wang_leaves_out(bench *b, uint32_t scene);

// Settings of pictures with the size and the samples of the run.
olx_render_settings wang_picture(const bench *b, olx_method method);
// The probes with maps as --texels wants them, which says what becomes of 512 texels.
bench_probes wang_probes(const bench *b, const bench_probes *probes);
uint32_t wang_rounds(const bench *b);

// What a set of probes gives.
typedef struct wang_quality {
  bench_error glossy, beauty, glossy_camera[BENCH_CAMERAS];
} wang_quality;
// Renders the scene's cameras from a field and compares. `pictures` receives what was rendered, to be freed in any
// case.
olx_result wang_compare(const wang_view *view, const olx_field *field, olx_tracer tracer, olx_select select,
                        const char *name, wang_quality *quality, bench_images *pictures);

#endif
