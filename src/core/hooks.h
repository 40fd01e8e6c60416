// Memory and log messages through the host's hooks.
#ifndef OLX_CORE_HOOKS_H
#define OLX_CORE_HOOKS_H

#include <octalux/base.h>

const olx_hooks *olx_get_hooks(void);

// Allocates uninitialised memory aligned to 64 bytes; NULL when there is none or when count * size overflows. 0 bytes
// are allowed.
void *olx_allocate(size_t count, size_t size_bytes);
// Allocates memory as olx_allocate does, and fills it with zero.
void *olx_allocate_zero(size_t count, size_t size_bytes);
// Releases memory of olx_allocate. NULL is allowed.
void olx_release(void *memory);

// Returns a copy of a string, or NULL when there is no memory.
char *olx_copy_string(const char *text);

void olx_log(olx_log_level level, const char *format, ...) __attribute__((format(printf, 2, 3)));

#endif
