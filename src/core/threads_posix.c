// Implements the runtime's threads, locks and clocks with those of POSIX.
#include "core/threads.h"

#include <pthread.h>
#include <time.h>
#include <unistd.h>

enum { MAX_THREADS = 256 };

typedef struct thread_body {
  void (*body)(void *user);
  void *user;
} thread_body;

static void *run_body(void *user) {
  const thread_body *b = user;
  b->body(b->user);
  return NULL;
}

void olx_run_threads(uint32_t threads, void (*body)(void *user), void *user) {
  thread_body b = {body, user};
  pthread_t handles[MAX_THREADS];
  uint32_t started = 0;
  const uint32_t wanted = threads < MAX_THREADS ? threads : MAX_THREADS;
  // A thread that cannot be started is not a failure, because this thread does its share.
  while (started + 1 < wanted && pthread_create(&handles[started], NULL, run_body, &b) == 0) started++;
  body(user);
  for (uint32_t i = 0; i < started; i++) pthread_join(handles[i], NULL);
}

uint32_t olx_processor_count(void) {
  const long count = sysconf(_SC_NPROCESSORS_ONLN);
  return count < 1 ? 1 : count > MAX_THREADS ? MAX_THREADS : (uint32_t)count;
}

_Static_assert(sizeof(pthread_mutex_t) <= sizeof(olx_lock) && _Alignof(pthread_mutex_t) <= _Alignof(olx_lock),
               "a lock holds a mutex");

static pthread_mutex_t *mutex_of(olx_lock *lock) { return (pthread_mutex_t *)(void *)lock->state; }

void olx_lock_create(olx_lock *lock) { pthread_mutex_init(mutex_of(lock), NULL); }

void olx_lock_destroy(olx_lock *lock) { pthread_mutex_destroy(mutex_of(lock)); }

void olx_lock_take(olx_lock *lock) { pthread_mutex_lock(mutex_of(lock)); }

bool olx_lock_try(olx_lock *lock) { return pthread_mutex_trylock(mutex_of(lock)) == 0; }

void olx_lock_give(olx_lock *lock) { pthread_mutex_unlock(mutex_of(lock)); }

static double read_clock(clockid_t clock) {
  struct timespec now;
  clock_gettime(clock, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

double olx_seconds(void) { return read_clock(CLOCK_MONOTONIC); }

double olx_thread_seconds(void) { return read_clock(CLOCK_THREAD_CPUTIME_ID); }
