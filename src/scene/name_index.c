// Finds elements by name through a hash table, whose chains keep the order in which elements were added.
#include "scene/name_index.h"

#include "core/hooks.h"
#include "core/result.h"

#include <string.h>

#define XXH_INLINE_ALL
#include <xxhash.h>

static uint64_t hash_of(const char *name) { return XXH3_64bits(name, strlen(name)); }

void olx_name_index_free(olx_name_index *index) {
  olx_release(index->first);
  olx_release(index->last);
  olx_release(index->next);
  olx_release(index->hashes);
  *index = (olx_name_index){0};
}

static void append(olx_name_index *index, uint64_t hash) {
  const uint32_t element = index->count++, bucket = (uint32_t)(hash & (index->capacity - 1));
  index->hashes[element] = hash;
  index->next[element] = OLX_NO_ELEMENT;
  if (index->first[bucket] == OLX_NO_ELEMENT) index->first[bucket] = element;
  else index->next[index->last[bucket]] = element;
  index->last[bucket] = element;
}

static olx_result grow(olx_name_index *index) {
  olx_name_index grown = {.capacity = index->capacity ? index->capacity * 2 : 64};
  grown.first = olx_allocate(grown.capacity, sizeof *grown.first);
  grown.last = olx_allocate(grown.capacity, sizeof *grown.last);
  grown.next = olx_allocate(grown.capacity, sizeof *grown.next);
  grown.hashes = olx_allocate(grown.capacity, sizeof *grown.hashes);
  if (!grown.first || !grown.last || !grown.next || !grown.hashes) {
    olx_name_index_free(&grown);
    return olx_fail(OLX_ERROR_MEMORY, "out of memory for an index of names");
  }
  for (uint32_t i = 0; i < grown.capacity; ++i) grown.first[i] = OLX_NO_ELEMENT;
  for (uint32_t i = 0; i < index->count; ++i) append(&grown, index->hashes[i]);
  olx_name_index_free(index);
  *index = grown;
  return OLX_OK;
}

olx_result olx_name_index_add(olx_name_index *index, const char *name) {
  if (index->count == index->capacity) OLX_TRY(grow(index));
  append(index, hash_of(name));
  return OLX_OK;
}

uint32_t olx_name_index_find(const olx_name_index *index, const char *name, uint32_t after) {
  if (!index->count) return OLX_NO_ELEMENT;
  const uint64_t hash = hash_of(name);
  uint32_t element = after == OLX_NO_ELEMENT ? index->first[hash & (index->capacity - 1)] : index->next[after];
  while (element != OLX_NO_ELEMENT && index->hashes[element] != hash) element = index->next[element];
  return element;
}
