// An index of elements by their names, so that finding one does not take longer the more there are.
#ifndef OLX_SCENE_NAME_INDEX_H
#define OLX_SCENE_NAME_INDEX_H

#include <octalux/base.h>

#define OLX_NO_ELEMENT UINT32_MAX

// Zero-initialise. Elements are numbered from 0 in the order in which they are added.
typedef struct olx_name_index {
  uint32_t *first, *last; // of a bucket; as many buckets as `capacity`
  uint32_t *next;         // of an element: the next one in its bucket
  uint64_t *hashes;       // of an element's name
  uint32_t count, capacity;
} olx_name_index;

void olx_name_index_free(olx_name_index *index);

// Add the next element.
olx_result olx_name_index_add(olx_name_index *index, const char *name);

// Elements whose names may be `name`, in ascending order: the caller compares. `after` is the one found last, or
// OLX_NO_ELEMENT to begin; OLX_NO_ELEMENT comes back when there are no more.
uint32_t olx_name_index_find(const olx_name_index *index, const char *name, uint32_t after);

#endif
