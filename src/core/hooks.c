// Holds the host's hooks for memory, messages and the parallel loop, with defaults from the C library, and allocates
// and logs through them.
#include "core/hooks.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void *default_allocate(void *user, size_t size_bytes) {
  (void)user;
  return aligned_alloc(64, (size_bytes + 63) & ~(size_t)63);
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
