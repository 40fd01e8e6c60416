// Working memory that jobs of a parallel loop take and give back, so that no more is made than jobs run at once,
// whatever runs them.
#ifndef OLX_BAKE_SCRATCH_POOL_H
#define OLX_BAKE_SCRATCH_POOL_H

#include <pthread.h>
#include <stddef.h>

typedef struct olx_scratch_pool {
  pthread_mutex_t lock;
  size_t size_bytes;
  struct olx_scratch_block *free_blocks;
} olx_scratch_pool;

void olx_scratch_pool_begin(olx_scratch_pool *pool, size_t size_bytes);
// All blocks must have been given back.
void olx_scratch_pool_end(olx_scratch_pool *pool);

// A block of the pool's size, uninitialised, aligned to 64 bytes, or NULL when there is no memory.
void *olx_scratch_take(olx_scratch_pool *pool);
void olx_scratch_give(olx_scratch_pool *pool, void *memory);

#endif
