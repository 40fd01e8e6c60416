// octalux-bake-mpi: bakes as `octalux bake` does, on all ranks of an MPI job, which share a work folder (docs/farm.md).
// Each rank is a part of the bake that stays in memory, and sleeps while only others can compute what it waits for.
#include "bake_driver.h"
#include "options.h"
#include "report.h"
#include "stop.h"

#include <mpi.h>
#include <sched.h>
#include <stdio.h>
#include <time.h>
#include <unistd.h>

#define NAME "octalux-bake-mpi"

// Pauses between two looks at what a rank waits for: as long as a tenth of the wait so far, within these.
#define SHORTEST_PAUSE_SECONDS 0.001
#define LONGEST_PAUSE_SECONDS 0.1

enum { MOST_REPAIRS = 16 }; // calls that compute damaged units anew

typedef struct crew {
  int rank, ranks;
  int ranks_here; // of them on this machine
  bool told;      // the ranks know whether to work
} crew;

static void pause_after(double waited_seconds) {
  double seconds = 0.1 * waited_seconds;
  if (seconds < SHORTEST_PAUSE_SECONDS) seconds = SHORTEST_PAUSE_SECONDS;
  if (seconds > LONGEST_PAUSE_SECONDS) seconds = LONGEST_PAUSE_SECONDS;
  nanosleep(&(struct timespec){.tv_nsec = (long)(seconds * 1e9)}, NULL);
}

static void complete(MPI_Request *request) {
  const double start = MPI_Wtime();
  int done = 0;
  for (MPI_Test(request, &done, MPI_STATUS_IGNORE); !done; MPI_Test(request, &done, MPI_STATUS_IGNORE)) {
    pause_after(MPI_Wtime() - start);
  }
}

static void meet(void) {
  MPI_Request request;
  MPI_Ibarrier(MPI_COMM_WORLD, &request);
  complete(&request);
}

// Returns the number that rank 0 gives.
static int hear(int number) {
  MPI_Request request;
  MPI_Ibcast(&number, 1, MPI_INT, 0, MPI_COMM_WORLD, &request);
  complete(&request);
  return number;
}

// ---- What the ranks agree on: first whether to work, then whether the work folder is ready

enum { GO_ON = -1 }; // otherwise the exit code

static bool begin_crew(void *user) {
  crew *c = user;
  if (c->rank != 0) return true; // rank 0 has checked
  c->told = true;
  return hear(GO_ON) == GO_ON;
}

// ---- The work of a rank

// Returns the processors that a rank may use: those that it is bound to, but at most its share of the machine, because
// several ranks may be bound to the same ones.
static uint32_t default_threads(const crew *c) {
  cpu_set_t processors;
  const long share = sysconf(_SC_NPROCESSORS_ONLN) / c->ranks_here;
  const long bound = sched_getaffinity(0, sizeof processors, &processors) == 0 ? CPU_COUNT(&processors) : share;
  const long count = bound < share ? bound : share;
  return count > 0 ? (uint32_t)count : 1;
}

static bool wait_for_others(void *user, double waited_seconds) {
  (void)user;
  pause_after(waited_seconds);
  return true;
}

static olx_result bake_part(const crew *c, const driven_bake *bake) {
  olx_bake_settings settings = bake->settings;
  progress_line line;
  progress_begin(&line, "bake", bake->shows_progress && c->rank == 0);
  line.shown = bake->shows_progress && c->rank == 0;
  const olx_progress progress = progress_of(&line);
  settings.work.fresh = false;
  settings.work.wait = wait_for_others;
  settings.work.part = (uint32_t)c->rank + 1;
  settings.work.parts = (uint32_t)c->ranks;
  olx_result result = olx_bake(bake->scene, &settings, bake->path, &progress, NULL);
  // The rank that finds a damaged unit computes it, because the rank that it belongs to may be waiting for this one.
  settings.work.part = settings.work.parts = 1;
  for (int i = 0; i < MOST_REPAIRS && result == OLX_ERROR_INCOMPLETE; i++) {
    result = olx_bake(bake->scene, &settings, bake->path, &progress, NULL);
  }
  progress_end(&line);
  return result;
}

static int run_crew(void *user, driven_bake *bake, bool *collects) {
  const crew *c = user;
  *collects = c->rank == 0;
  if (bake->settings.threads == 0) bake->settings.threads = default_threads(c);
  int code = GO_ON;
  if (c->rank == 0 && olx_bake_prepare(bake->scene, &bake->settings, bake->path) != OLX_OK) {
    code = library_failure("bake");
  }
  code = hear(code);
  if (code != GO_ON) return code;
  const olx_result result = bake_part(c, bake);
  if (result == OLX_ERROR_CANCELLED) {
    return failure(NAME, "rank %d: interrupted; %s holds what is done, and the same command%s goes on from it", c->rank,
                   bake->settings.work.folder, bake->settings.work.fresh ? " without --fresh" : "");
  }
  if (result != OLX_OK) return library_failure("bake");
  bake->settings.work.fresh = false;
  meet();
  return EXIT_DONE;
}

static int run_rank(crew *c, int argc, char **argv) {
  const bake_driver driver = {.name = NAME,
                              .summary = "Bake like octalux bake, on all ranks of an MPI job that share a folder.",
                              .example = "mpirun octalux-bake-mpi room.gltf --probes probes.json -o room.olx",
                              .checked = begin_crew,
                              .run = run_crew,
                              .user = c};
  if (c->rank != 0) {
    const int code = hear(0);
    return code == GO_ON ? bake_with(&driver, argc, argv) : code;
  }
  const int code = bake_with(&driver, argc, argv);
  return c->told ? code : hear(code);
}

// Counts the ranks on this machine.
static int count_here(void) {
  MPI_Comm here;
  int count = 1;
  MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &here);
  MPI_Comm_size(here, &count);
  MPI_Comm_free(&here);
  return count;
}

int main(int argc, char **argv) {
  crew c = {0};
  int level;
  stop_watch(NAME);
  MPI_Init_thread(NULL, NULL, MPI_THREAD_FUNNELED, &level);
  MPI_Comm_rank(MPI_COMM_WORLD, &c.rank);
  MPI_Comm_size(MPI_COMM_WORLD, &c.ranks);
  c.ranks_here = count_here();
  int code = stop_exit_code(run_rank(&c, argc, argv));
  if (fflush(stdout) != 0 && code == EXIT_DONE) code = failure(NAME, "standard output: cannot write");
  // A rank that failed leaves without MPI_Finalize, by which mpirun ends the others and returns the exit code.
  if (code != EXIT_DONE) return code;
  meet();
  MPI_Finalize();
  return EXIT_DONE;
}
