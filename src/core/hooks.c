// Holds the host's hooks for memory, messages and the parallel loop, with defaults from the C library, and allocates
// and logs through them.
#include "core/hooks.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#ifdef __linux__
#include <sys/mman.h>
#endif

static size_t round_up(size_t size_bytes, size_t alignment) {
  return (size_bytes + alignment - 1) / alignment * alignment;
}

// Large arrays lie in huge pages where the system has them: rays read textures, surfels and their tables from all over,
// and addresses of small pages would be looked up anew each time. Only the whole huge pages within an array are asked
// for, so that one whose every byte is used takes no more memory.
static void *default_allocate(void *user, size_t size_bytes) {
  (void)user;
#ifdef MADV_HUGEPAGE
  enum { HUGE_PAGE = 2 << 20, LEAST_PAGES = 2 };
  if (size_bytes >= (size_t)LEAST_PAGES * HUGE_PAGE) {
    void *memory = aligned_alloc(HUGE_PAGE, round_up(size_bytes, HUGE_PAGE));
    if (memory) (void)madvise(memory, size_bytes / HUGE_PAGE * HUGE_PAGE, MADV_HUGEPAGE);
    return memory;
  }
#endif
  return aligned_alloc(64, round_up(size_bytes, 64));
}

static void default_release(void *user, void *memory) {
  (void)user;
  free(memory);
}

static void default_log(void *user, olx_log_level level, const char *message) {
  (void)user;
  if (level >= OLX_LOG_WARNING) fprintf(stderr, "%s: %s\n", level == OLX_LOG_WARNING ? "warning" : "error", message);
}

static olx_hooks hooks = {.allocate = default_allocate, .release = default_release, .log = default_log};

void olx_set_hooks(const olx_hooks *replacement) {
  hooks = replacement ? *replacement : (olx_hooks){0};
  // A host sets both functions of its allocator or neither, because memory must return to the allocator that gave it.
  if (!hooks.allocate || !hooks.release) {
    hooks.allocate = default_allocate;
    hooks.release = default_release;
  }
  if (!hooks.log) hooks.log = default_log;
}

const olx_hooks *olx_get_hooks(void) { return &hooks; }

void *olx_allocate(size_t count, size_t size_bytes) {
  size_t total;
  if (__builtin_mul_overflow(count, size_bytes, &total) || total > SIZE_MAX / 2) return NULL;
  return hooks.allocate(hooks.user, total ? total : 1);
}

void *olx_allocate_zero(size_t count, size_t size_bytes) {
  void *memory = olx_allocate(count, size_bytes);
  if (memory) memset(memory, 0, count * size_bytes);
  return memory;
}

void olx_release(void *memory) {
  if (memory) hooks.release(hooks.user, memory);
}

char *olx_copy_string(const char *text) {
  const size_t size_bytes = strlen(text) + 1;
  char *copy = olx_allocate(size_bytes, 1);
  if (copy) memcpy(copy, text, size_bytes);
  return copy;
}

void olx_log(olx_log_level level, const char *format, ...) {
  char message[1024], printable[sizeof message];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(message, sizeof message, format, arguments);
  va_end(arguments);
  olx_printable(message, printable, sizeof printable);
  hooks.log(hooks.user, level, printable);
}
