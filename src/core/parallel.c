// Runs the parallel loop on POSIX threads or through the host's hook, and keeps the progress and the cancellation of
// each thread's task.
#include "core/parallel.h"

#include "core/hooks.h"
#include "core/result.h"

enum { REPORT_INTERVAL_MS = 100 };

// The innermost task that this thread has begun and not yet ended.
static _Thread_local olx_task *current_task;

void olx_task_begin(olx_task *task, const olx_progress *progress, const char *stage, uint64_t total_units) {
  task->outer = current_task;
  current_task = task;
  task->progress = progress;
  task->stage = stage;
  task->total_units = total_units ? total_units : 1;
  atomic_init(&task->done_units, 0);
  atomic_init(&task->cancelled, false);
  atomic_init(&task->last_report_ms, 0);
  olx_lock_create(&task->report_lock);
}

void olx_task_stage(olx_task *task, const char *stage) { task->stage = stage; }

void olx_task_end(olx_task *task) {
  current_task = task->outer;
  olx_lock_destroy(&task->report_lock);
}

static bool report_due(olx_task *task) {
  return (uint64_t)(olx_seconds() * 1e3) >= atomic_load(&task->last_report_ms) + REPORT_INTERVAL_MS;
}

void olx_task_advance(olx_task *task, uint64_t units) {
  const uint64_t before = atomic_fetch_add(&task->done_units, units);
  const bool last = before < task->total_units && before + units >= task->total_units;
  if (!task->progress || !task->progress->report) return;
  if (last) olx_lock_take(&task->report_lock);
  else if (!report_due(task) || !olx_lock_try(&task->report_lock)) return;
  // Another thread may have reported or cancelled in the meantime; reading progress under the lock keeps it from going
  // back.
  if (!atomic_load(&task->cancelled) && (last || report_due(task))) {
    atomic_store(&task->last_report_ms, (uint64_t)(olx_seconds() * 1e3));
    const float share = (float)((double)atomic_load(&task->done_units) / (double)task->total_units);
    if (!task->progress->report(task->progress->user, task->stage, share > 1 ? 1 : share)) {
      atomic_store(&task->cancelled, true);
    }
  }
  olx_lock_give(&task->report_lock);
}

olx_task *olx_task_current(void) { return current_task; }

bool olx_task_cancelled(olx_task *task) {
  for (; task; task = task->outer) {
    olx_task_advance(task, 0);
    if (atomic_load(&task->cancelled)) return true;
  }
  return false;
}

static olx_result fail_cancelled(const olx_task *task) {
  return olx_fail(OLX_ERROR_CANCELLED, "cancelled during %s", task->stage);
}

olx_result olx_check_cancelled(void) {
  return olx_task_cancelled(current_task) ? fail_cancelled(current_task) : OLX_OK;
}

olx_result olx_watch(const olx_progress *progress, const char *stage, olx_result (*work)(void *user), void *user) {
  olx_task task;
  olx_task_begin(&task, progress, stage, 1);
  const olx_result result = work(user);
  olx_task_end(&task);
  return result;
}

typedef struct loop {
  olx_job job;
  void *user;
  olx_task *task;
  uint64_t units;
  uint32_t count;
  atomic_uint next;
} loop;

static void run_index(void *user, uint32_t index) {
  loop *l = user;
  if (l->task && atomic_load_explicit(&l->task->cancelled, memory_order_relaxed)) return;
  l->job(l->user, index);
  if (l->task) olx_task_advance(l->task, l->units);
}

static void run_thread(void *user) {
  loop *l = user;
  for (;;) {
    const uint32_t index = atomic_fetch_add(&l->next, 1);
    if (index >= l->count) return;
    run_index(l, index);
  }
}

olx_result olx_parallel_for(uint32_t count, uint32_t threads, olx_job job, void *user, olx_task *task, uint64_t units) {
  olx_task *const watched = task ? task : current_task;
  loop l = {.job = job, .user = user, .task = watched, .units = task ? units : 0, .count = count};
  atomic_init(&l.next, 0);
  const olx_hooks *hooks = olx_get_hooks();
  if (hooks->parallel_for) {
    hooks->parallel_for(hooks->user, count, threads, run_index, &l);
  } else {
    const uint32_t wanted = threads ? threads : olx_processor_count();
    olx_run_threads(wanted < count ? wanted : count, run_thread, &l);
  }
  return watched && atomic_load(&watched->cancelled) ? fail_cancelled(watched) : OLX_OK;
}
