// What the experiments of Wang's thesis share: sets of probes on three scenes, their errors and times, measured once in a run.
#ifndef OCTALUX_BENCH_WANG_STUDY_H
#define OCTALUX_BENCH_WANG_STUDY_H

#include "experiment.h"
#include "wang.h"

enum { WANG_ERRORS = 1, WANG_TIMES = 2 };

typedef struct wang_study wang_study;

// One scene with what the experiment needs of it (all of it when all experiments run). *measured is NULL when the scene is
// left out, which the findings then tell. Its fields are closed; what is known of them stays.
olx_result wang_study_scene(bench *b, uint32_t scene, uint32_t parts, const wang_measured **measured);
// Pictures of some rows of a scene, from its cameras, beside the references.
olx_result wang_study_show(bench *b, uint32_t scene, const uint32_t *rows, uint32_t count);
// A row's set of probes: "16 sdf + gibbs".
bench_name wang_study_name(const bench *b, const wang_measured_row *row);
// NULL is allowed.
void wang_study_free(wang_study *study);

#endif
