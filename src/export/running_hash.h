// Computes olx_content_hash over bytes that arrive in pieces.
#ifndef OLX_EXPORT_RUNNING_HASH_H
#define OLX_EXPORT_RUNNING_HASH_H

#include <stddef.h>
#include <stdint.h>

#define XXH_INLINE_ALL
#include <xxhash.h>

typedef struct olx_running_hash {
  XXH3_state_t state;
} olx_running_hash;

static inline void olx_hash_begin(olx_running_hash *hash) { XXH3_64bits_reset(&hash->state); }
static inline void olx_hash_add(olx_running_hash *hash, const void *data, size_t size_bytes) {
  XXH3_64bits_update(&hash->state, data, size_bytes);
}
static inline uint64_t olx_hash_end(const olx_running_hash *hash) { return XXH3_64bits_digest(&hash->state); }

#endif
