// Lends blocks of scratch memory to the jobs of a parallel loop, and reuses returned blocks for later jobs.
#include "bake/scratch_pool.h"

#include "core/hooks.h"

struct olx_scratch_block {
  struct olx_scratch_block *next;
};

void olx_scratch_pool_begin(olx_scratch_pool *pool, size_t size_bytes) {
  pthread_mutex_init(&pool->lock, NULL);
  pool->size_bytes = size_bytes;
  pool->free_blocks = NULL;
}

void olx_scratch_pool_end(olx_scratch_pool *pool) {
  while (pool->free_blocks) {
    struct olx_scratch_block *block = pool->free_blocks;
    pool->free_blocks = block->next;
    olx_release(block);
  }
  pthread_mutex_destroy(&pool->lock);
}

void *olx_scratch_take(olx_scratch_pool *pool) {
  pthread_mutex_lock(&pool->lock);
  struct olx_scratch_block *block = pool->free_blocks;
  if (block) pool->free_blocks = block->next;
  pthread_mutex_unlock(&pool->lock);
  return block ? (void *)block : olx_allocate(1, pool->size_bytes);
}

void olx_scratch_give(olx_scratch_pool *pool, void *memory) {
  struct olx_scratch_block *block = memory;
  pthread_mutex_lock(&pool->lock);
  block->next = pool->free_blocks;
  pool->free_blocks = block;
  pthread_mutex_unlock(&pool->lock);
}
