// Memory for fuzzers: how many blocks are held, how much has been asked for, and none larger than 1 GiB. Messages go
// nowhere.
#ifndef OLX_TESTS_COUNTED_MEMORY_H
#define OLX_TESTS_COUNTED_MEMORY_H

#include <stddef.h>

// Install the hooks, while the library holds nothing.
void counted_memory_begin(void);
long counted_memory_held(void);
// Bytes of all blocks that were asked for since the last call, whether or not they are held.
size_t counted_memory_asked(void);

#endif
