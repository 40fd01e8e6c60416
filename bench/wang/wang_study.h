// Shared by the experiments of Wang's thesis: the rows of its scenes with errors and times, measured once per run.
#ifndef OCTALUX_BENCH_WANG_STUDY_H
#define OCTALUX_BENCH_WANG_STUDY_H

#include "wang_rows.h"

enum { WANG_ERRORS = 1, WANG_TIMES = 2 };

// Measures what the experiment needs of one scene (everything when all experiments run); `series` includes the sets of
// appendix A. *measured is NULL when the scene is left out, which the findings then report. Its fields are closed.
olx_result wang_study_scene(bench *b, uint32_t scene, uint32_t parts, bool series, wang_measured **measured);
// Shows images of some rows of a scene, from its cameras, beside the references.
olx_result wang_study_show(bench *b, uint32_t scene, const uint32_t *rows, uint32_t count, olx_layer layer);

// Returns the name of a tracer: "texel", "two-level", "hiz".
const char *wang_tracer_name(olx_tracer tracer);

#endif
