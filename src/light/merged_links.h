// Merges many links into few: those to the same surfel, then those to surfels of one node of a tree (link_tree.h), where they
// bring least. What is merged keeps its sum.
#ifndef OLX_LIGHT_MERGED_LINKS_H
#define OLX_LIGHT_MERGED_LINKS_H

#include "light/link_tree.h"

typedef struct olx_merged_link {
  uint32_t from;      // a surfel or node
  olx_vec3 weight;    // of its irradiance in what arrives
  olx_vec3 direction; // towards it: the mean of what was added, unit; 0 where nothing was
} olx_merged_link;

// Links of one place at a time. Each thread has a merger of its own.
typedef struct olx_link_merger {
  const olx_link_tree *tree;
  olx_vec3 *weights, *directions; // of every surfel and node; 0 between places
  bool *named;
  uint32_t *numbers, count; // that are named
} olx_link_merger;

olx_result olx_link_merger_create(olx_link_merger *merger, const olx_link_tree *tree);
void olx_link_merger_free(olx_link_merger *merger);

// A link to a surfel. Its direction may be 0.
void olx_link_merger_add(olx_link_merger *merger, uint32_t surfel, olx_vec3 weight, olx_vec3 direction);

// What was added, as at most `most` links: the heaviest are divided first. Returns how many; the merger is empty then.
uint32_t olx_link_merger_take(olx_link_merger *merger, uint32_t most, olx_merged_link *links);

#endif
