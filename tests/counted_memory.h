// Memory for fuzzers: how many blocks are held, and none larger than 1 GiB. Messages go nowhere.
#ifndef OLX_TESTS_COUNTED_MEMORY_H
#define OLX_TESTS_COUNTED_MEMORY_H

// Install the hooks, while the library holds nothing.
void counted_memory_begin(void);
long counted_memory_held(void);

#endif
