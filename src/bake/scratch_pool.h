// Scratch memory that jobs of a parallel loop take and return, so that there are never more blocks than concurrent
// jobs.
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
// Frees the pool. All blocks must have been returned.
void olx_scratch_pool_end(olx_scratch_pool *pool);

// Takes a block of the pool's size, uninitialized and aligned to 64 bytes; NULL when memory runs out.
void *olx_scratch_take(olx_scratch_pool *pool);
void olx_scratch_give(olx_scratch_pool *pool, void *memory);

#endif
