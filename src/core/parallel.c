// Runs the parallel loop on POSIX threads or on the host's hook, and keeps the progress and the cancellation of the
// task that each thread works on.
#include "core/parallel.h"

#include "core/hooks.h"
#include "core/result.h"

#include <time.h>
#include <unistd.h>

enum { MAX_THREADS = 256, REPORT_INTERVAL_MS = 100 };

static double read_clock(clockid_t clock) {
  struct timespec now;
  clock_gettime(clock, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

double olx_seconds(void) { return read_clock(CLOCK_MONOTONIC); }

double olx_thread_seconds(void) { return read_clock(CLOCK_THREAD_CPUTIME_ID); }

uint32_t olx_processor_count(void) {
  const long count = sysconf(_SC_NPROCESSORS_ONLN);
  return count < 1 ? 1 : count > MAX_THREADS ? MAX_THREADS : (uint32_t)count;
}

// The innermost task that this thread has begun and not ended.
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
  pthread_mutex_init(&task->report_lock, NULL);
}

void olx_task_stage(olx_task *task, const char *stage) { task->stage = stage; }

void olx_task_end(olx_task *task) {
  current_task = task->outer;
  pthread_mutex_destroy(&task->report_lock);
}

static bool report_due(olx_task *task) {
  return (uint64_t)(olx_seconds() * 1e3) >= atomic_load(&task->last_report_ms) + REPORT_INTERVAL_MS;
}

void olx_task_advance(olx_task *task, uint64_t units) {
  const uint64_t before = atomic_fetch_add(&task->done_units, units);
  const bool last = before < task->total_units && before + units >= task->total_units;
  if (!task->progress || !task->progress->report) return;
  if (last) pthread_mutex_lock(&task->report_lock);
  else if (!report_due(task) || pthread_mutex_trylock(&task->report_lock) != 0) return;
  // Another thread may have reported, or been told to stop, since; read under the lock, what is done never goes back.
  if (!atomic_load(&task->cancelled) && (last || report_due(task))) {
    atomic_store(&task->last_report_ms, (uint64_t)(olx_seconds() * 1e3));
    const float share = (float)((double)atomic_load(&task->done_units) / (double)task->total_units);
    if (!task->progress->report(task->progress->user, task->stage, share > 1 ? 1 : share)) {
      atomic_store(&task->cancelled, true);
    }
  }
  pthread_mutex_unlock(&task->report_lock);
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

static void *run_thread(void *user) {
  loop *l = user;
  for (;;) {
    const uint32_t index = atomic_fetch_add(&l->next, 1);
    if (index >= l->count) return NULL;
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
    uint32_t wanted = threads ? threads : olx_processor_count();
    if (wanted > MAX_THREADS) wanted = MAX_THREADS;
    if (wanted > count) wanted = count;
    pthread_t handles[MAX_THREADS];
    uint32_t started = 0;
    // A thread that cannot be started is no failure: this one does its share.
    while (started + 1 < wanted && pthread_create(&handles[started], NULL, run_thread, &l) == 0) started++;
    run_thread(&l);
    for (uint32_t i = 0; i < started; i++) pthread_join(handles[i], NULL);
  }
  return watched && atomic_load(&watched->cancelled) ? fail_cancelled(watched) : OLX_OK;
}
