// Implements threads, locks and clocks with nothing but C17: loops run on the calling thread, or on the threads of the
// host's hook. Those threads spin on a lock, which is held only for one report of progress.
#include "core/threads.h"

#include <stdatomic.h>
#include <time.h>

void olx_run_threads(uint32_t threads, void (*body)(void *user), void *user) {
  (void)threads;
  body(user);
}

uint32_t olx_processor_count(void) { return 1; }

_Static_assert(sizeof(atomic_flag) <= sizeof(olx_lock), "a lock holds a flag");

static atomic_flag *flag_of(olx_lock *lock) { return (atomic_flag *)(void *)lock->state; }

void olx_lock_create(olx_lock *lock) { atomic_flag_clear(flag_of(lock)); }

void olx_lock_destroy(olx_lock *lock) { (void)lock; }

void olx_lock_take(olx_lock *lock) {
  while (!olx_lock_try(lock)) {}
}

bool olx_lock_try(olx_lock *lock) { return !atomic_flag_test_and_set(flag_of(lock)); }

void olx_lock_give(olx_lock *lock) { atomic_flag_clear(flag_of(lock)); }

// Returns the time of C17's calendar clock, which is monotonic unless somebody sets it.
double olx_seconds(void) {
  struct timespec now;
  timespec_get(&now, TIME_UTC);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

double olx_thread_seconds(void) { return (double)clock() / CLOCKS_PER_SEC; }
