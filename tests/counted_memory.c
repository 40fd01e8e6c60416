// Counts the memory that the library holds and requests, by hooks that refuse blocks above 1 GiB, for fuzzers.
#include "counted_memory.h"

#include <octalux/base.h>

#include <stdatomic.h>
#include <stdlib.h>

#define MOST_BYTES ((size_t)1 << 30)

static atomic_long held;
static atomic_size_t asked;

static void *counted_allocate(void *user, size_t size_bytes) {
  (void)user;
  atomic_fetch_add(&asked, size_bytes);
  if (size_bytes > MOST_BYTES) return NULL;
  void *memory = aligned_alloc(64, (size_bytes + 63) & ~(size_t)63);
  if (memory) atomic_fetch_add(&held, 1);
  return memory;
}

static void counted_release(void *user, void *memory) {
  (void)user;
  atomic_fetch_sub(&held, 1);
  free(memory);
}

static void discard_message(void *user, olx_log_level level, const char *message) {
  (void)user, (void)level, (void)message;
}

void counted_memory_begin(void) {
  olx_set_hooks(&(olx_hooks){.allocate = counted_allocate, .release = counted_release, .log = discard_message});
}

long counted_memory_held(void) { return atomic_load(&held); }

size_t counted_memory_asked(void) { return atomic_exchange(&asked, 0); }
