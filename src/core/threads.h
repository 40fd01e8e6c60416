// Threads, locks and clocks of the system. threads_posix.c implements them for POSIX; threads_plain.c needs only C17
// and has one thread and locks without contention. A port to another system adds one such file.
#ifndef OLX_CORE_THREADS_H
#define OLX_CORE_THREADS_H

#include <stdbool.h>
#include <stdint.h>

// Runs body(user) on the calling thread and in parallel on as many others as make `threads` of them, and waits for all.
// Where fewer can be started, fewer run: the bodies share the work among themselves.
void olx_run_threads(uint32_t threads, void (*body)(void *user), void *user);

// Returns the number of processors that this process may use, at least 1.
uint32_t olx_processor_count(void);

// A lock that one thread holds at a time. Its bytes are defined by the system.
typedef struct olx_lock {
  _Alignas(16) unsigned char state[64];
} olx_lock;

void olx_lock_create(olx_lock *lock);
void olx_lock_destroy(olx_lock *lock);
void olx_lock_take(olx_lock *lock);
// Takes the lock if nobody holds it, and returns whether it did.
bool olx_lock_try(olx_lock *lock);
void olx_lock_give(olx_lock *lock);

// Returns the seconds of a monotonic clock.
double olx_seconds(void);

// Returns the processor time of the calling thread in seconds: the cost of its work, however many others share the
// processors.
double olx_thread_seconds(void);

#endif
