// Threads, locks and clocks of the system. threads_posix.c has them for POSIX, threads_plain.c for systems of which
// nothing but C17 is known: one thread, and locks that nobody contends for. A port to another system writes one such
// file.
#ifndef OLX_CORE_THREADS_H
#define OLX_CORE_THREADS_H

#include <stdbool.h>
#include <stdint.h>

// Run body(user) on the calling thread and at once on as many others as make `threads` of them, and wait for all. Where
// fewer can be started, fewer run: what there is to do, the bodies share among themselves.
void olx_run_threads(uint32_t threads, void (*body)(void *user), void *user);

// Processors this process may use, at least 1.
uint32_t olx_processor_count(void);

// A lock that one thread holds at a time. Its bytes are the system's.
typedef struct olx_lock {
  _Alignas(16) unsigned char state[64];
} olx_lock;

void olx_lock_create(olx_lock *lock);
void olx_lock_destroy(olx_lock *lock);
void olx_lock_take(olx_lock *lock);
// Take the lock if nobody holds it; whether it was taken.
bool olx_lock_try(olx_lock *lock);
void olx_lock_give(olx_lock *lock);

// Seconds of a monotonic clock.
double olx_seconds(void);

// Processor time of the calling thread: what work costs, however many others share the processors.
double olx_thread_seconds(void);

#endif
