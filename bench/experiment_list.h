// Declares every experiment; each has its own file.
#ifndef OCTALUX_BENCH_EXPERIMENT_LIST_H
#define OCTALUX_BENCH_EXPERIMENT_LIST_H

#include "experiment.h"

olx_result run_mcguire_table1(bench *b);
olx_result run_mcguire_leaks(bench *b);
olx_result run_mcguire_area_light(bench *b);
olx_result run_mcguire_single_probe(bench *b);
olx_result run_mcguire_resolution(bench *b);
olx_result run_mcguire_count(bench *b);
olx_result run_wang_table1(bench *b);
olx_result run_wang_table2(bench *b);
olx_result run_wang_quality(bench *b);
olx_result run_wang(bench *b);
olx_result run_wang_probes(bench *b);
olx_result run_dissertation_rooms(bench *b);
olx_result run_dissertation_table1(bench *b);
olx_result run_bounces(bench *b);
olx_result run_relight(bench *b);
olx_result run_sh(bench *b);
olx_result run_surfaces(bench *b);
const char *surfaces_scene(uint32_t index);
const char *surfaces_set(uint32_t index);

#endif
