// The studies of octalux-bench, which take their own arguments and print their results.
#ifndef OCTALUX_BENCH_STUDIES_H
#define OCTALUX_BENCH_STUDIES_H

#include <stdint.h>

#define BENCH_PROGRAM "octalux-bench" // the program's name in messages

typedef struct bench_study {
  const char *name;      // name on the command line
  const char *arguments; // form of the arguments in the help; NULL: the study parses and documents its own options
  uint32_t least, most;  // least and greatest number of arguments
  const char *what;      // one line, for lists
  int (*run)(int argc, char **argv); // argv[0] is its name; returns the program's exit code
} bench_study;

extern const bench_study studies[];
extern const uint32_t study_count;

// Runs a study when the number of arguments is valid; otherwise prints what it takes.
int run_study(const bench_study *s, int argc, char **argv);
// Runs the experiments that the arguments name; argv[0] is the program's name.
int run_experiments(int argc, char **argv);

int study_bake_speed(int argc, char **argv);
int study_gpu(int argc, char **argv);
int study_runtime_speed(int argc, char **argv);
int study_selector_speed(int argc, char **argv);
int study_ray_race(int argc, char **argv);
int study_glossy_speed(int argc, char **argv);
int study_block_quality(int argc, char **argv);
int study_glossy_quality(int argc, char **argv);
int study_glossy_oracle(int argc, char **argv);
int study_glossy_causes(int argc, char **argv);
int study_light_quality(int argc, char **argv);
int study_light_picture(int argc, char **argv);
int study_placement_check(int argc, char **argv);
int study_probe_sets(int argc, char **argv);
int study_viewpoint_limit(int argc, char **argv);
int study_farm_simulation(int argc, char **argv);
int study_relight_causes(int argc, char **argv);
int study_seams(int argc, char **argv);
int study_scene_arrays(int argc, char **argv);

#endif
