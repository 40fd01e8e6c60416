// An index of elements by name, with lookup in constant time.
#ifndef OLX_SCENE_NAME_INDEX_H
#define OLX_SCENE_NAME_INDEX_H

#include <octalux/base.h>

#define OLX_NO_ELEMENT UINT32_MAX

// An index. Zero-initialize. Elements are numbered from 0 in the order in which they are added.
typedef struct olx_name_index {
  uint32_t *first, *last; // first and last element of each bucket; there are `capacity` buckets
  uint32_t *next;         // for each element, the next one in its bucket
  uint64_t *hashes;       // hash of each element's name
  uint32_t count, capacity;
} olx_name_index;

void olx_name_index_free(olx_name_index *index);

// Adds the next element.
olx_result olx_name_index_add(olx_name_index *index, const char *name);

// Finds elements whose names may be `name`, in ascending order; the caller compares the names. `after` is the last one
// found, or OLX_NO_ELEMENT to begin. Returns OLX_NO_ELEMENT when there are no more.
uint32_t olx_name_index_find(const olx_name_index *index, const char *name, uint32_t after);

#endif
