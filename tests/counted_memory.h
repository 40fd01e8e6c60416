// Memory hooks for fuzzers: they count blocks held and bytes requested, and refuse blocks above 1 GiB. Messages are
// discarded.
#ifndef OLX_TESTS_COUNTED_MEMORY_H
#define OLX_TESTS_COUNTED_MEMORY_H

#include <stddef.h>

// Install the hooks; the library must not hold any memory yet.
void counted_memory_begin(void);
long counted_memory_held(void);
// Returns the bytes of all blocks requested since the last call, whether or not they are still held.
size_t counted_memory_asked(void);

#endif
