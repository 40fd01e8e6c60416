// The one parallel loop. Results must not depend on which thread runs which index, or in what order.
#ifndef OLX_CORE_PARALLEL_H
#define OLX_CORE_PARALLEL_H

#include "core/threads.h"

#include <octalux/base.h>

#include <stdatomic.h>

// Progress of one long piece of work that runs several loops. The loops advance `done` from 0 to `total` units. From
// its begin to its end a task is the current one of the thread that began it, so that whatever this thread calls can be
// cancelled.
typedef struct olx_task {
  struct olx_task *outer;       // that was current when this one began; NULL: none
  const olx_progress *progress; // may be NULL
  const char *stage;
  uint64_t total_units;
  atomic_uint_fast64_t done_units;
  atomic_bool cancelled;
  atomic_uint_fast64_t last_report_ms;
  olx_lock report_lock;
} olx_task;

void olx_task_begin(olx_task *task, const olx_progress *progress, const char *stage, uint64_t total_units);
// Count units that no loop counts.
void olx_task_advance(olx_task *task, uint64_t units);
// Change the name of the stage; between loops only.
void olx_task_stage(olx_task *task, const char *stage);
void olx_task_end(olx_task *task);

// The calling thread's current task; NULL: none. Threads that run a loop's jobs have none of their own.
olx_task *olx_task_current(void);
// Report the task's progress when that is due, and return whether it or a task around it was cancelled. May be called
// from any thread; NULL is allowed and never cancelled. Costs a clock's reading.
bool olx_task_cancelled(olx_task *task);
// OLX_ERROR_CANCELLED when the calling thread's current task was cancelled: for serial loops that take long.
olx_result olx_check_cancelled(void);

typedef void (*olx_job)(void *user, uint32_t index);

// Run job(user, i) for every i in [0, count) on `threads` threads (0: as many as the machine has) and wait for all.
// Every finished index adds `units` to the progress of `task`; when the task is cancelled the remaining indices are
// skipped and OLX_ERROR_CANCELLED is returned. task may be NULL: then the thread's current task, if any, cancels the
// loop, and units do not count.
olx_result olx_parallel_for(uint32_t count, uint32_t threads, olx_job job, void *user, olx_task *task, uint64_t units);

#endif
