// The host's hooks, and what uses them: memory and log messages.
#ifndef OLX_CORE_HOOKS_H
#define OLX_CORE_HOOKS_H

#include <octalux/base.h>

const olx_hooks *olx_get_hooks(void);

// Memory aligned to 64 bytes, uninitialised; NULL when there is none or when count * size overflows. 0 bytes are
// allowed.
void *olx_allocate(size_t count, size_t size_bytes);
// Allocates as olx_allocate does, and fills the memory with zero.
void *olx_allocate_zero(size_t count, size_t size_bytes);
// NULL is allowed.
void olx_release(void *memory);

// A copy of a string, or NULL when there is no memory.
char *olx_copy_string(const char *text);

void olx_log(olx_log_level level, const char *format, ...) __attribute__((format(printf, 2, 3)));

#endif
