// octalux-bench: runs the experiment of the papers, all experiments, or the study that its first argument names.
#include "options.h"
#include "stop.h"
#include "studies.h"

#include <stdio.h>
#include <string.h>

static int dispatch(int argc, char **argv) {
  for (uint32_t i = 0; argc > 1 && i < study_count; ++i) {
    if (strcmp(argv[1], studies[i].name) == 0) return run_study(&studies[i], argc - 1, argv + 1);
  }
  return run_experiments(argc, argv);
}

int main(int argc, char **argv) {
  static char name[] = BENCH_PROGRAM;
  if (argc > 0) argv[0] = name;
  stop_watch(BENCH_PROGRAM);
  const int code = stop_exit_code(dispatch(argc, argv));
  if (fflush(stdout) == 0 && !ferror(stdout)) return code;
  return code != EXIT_DONE ? code : failure(BENCH_PROGRAM, "standard output: cannot write");
}
