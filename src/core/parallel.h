// The only parallel loop. Results must not depend on which thread runs which index, or in what order.
#ifndef OLX_CORE_PARALLEL_H
#define OLX_CORE_PARALLEL_H

#include "core/threads.h"

#include <octalux/base.h>

#include <stdatomic.h>

// The progress of one long piece of work that runs several loops, which together advance `done_units` from 0 to
// `total_units`. From its beginning to its end, it is the current task of the thread that began it, so that everything
// this thread calls can be cancelled.
typedef struct olx_task {
  struct olx_task *outer;       // the task that was current when this one began; NULL: none
  const olx_progress *progress; // may be NULL
  const char *stage;
  uint64_t total_units;
  atomic_uint_fast64_t done_units;
  atomic_bool cancelled;
  atomic_uint_fast64_t last_report_ms;
  olx_lock report_lock;
} olx_task;

void olx_task_begin(olx_task *task, const olx_progress *progress, const char *stage, uint64_t total_units);
// Adds units that no loop counts.
void olx_task_advance(olx_task *task, uint64_t units);
// Changes the name of the stage; between loops only.
void olx_task_stage(olx_task *task, const char *stage);
void olx_task_end(olx_task *task);

// Returns the calling thread's current task, or NULL. Threads that run a loop's jobs have no task of their own.
olx_task *olx_task_current(void);
// Reports the task's progress when that is due, and returns whether it or a task around it was cancelled. May be called
// from any thread; NULL is allowed and never cancelled. Costs a reading of the clock.
bool olx_task_cancelled(olx_task *task);
// Returns OLX_ERROR_CANCELLED when the calling thread's current task was cancelled; for long serial loops.
olx_result olx_check_cancelled(void);

typedef void (*olx_job)(void *user, uint32_t index);

// Runs job(user, i) for every i in [0, count) on `threads` threads (0: as many as the machine has) and waits for all.
// Every finished index adds `units` to the progress of `task`. When the task is cancelled, the remaining indices are
// skipped and OLX_ERROR_CANCELLED is returned. If `task` is NULL, the thread's current task, if any, can cancel the
// loop, and no units are counted.
olx_result olx_parallel_for(uint32_t count, uint32_t threads, olx_job job, void *user, olx_task *task, uint64_t units);

#endif
