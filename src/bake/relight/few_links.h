// Reduces the number of links of a place: links to the same surfel are merged; where too many remain, the heaviest are
// kept unchanged and some of the others are drawn at random and reweighted. The result is unbiased.
#ifndef OLX_BAKE_FEW_LINKS_H
#define OLX_BAKE_FEW_LINKS_H

#include "core/vec.h"

#include <octalux/base.h>

typedef struct olx_few_link {
  uint32_t from;      // index of a surfel
  olx_vec3 weight;    // share of the surfel's irradiance that arrives
  olx_vec3 direction; // towards the surfel: the mean of the added directions, weighted by luminance
  float straight;     // luminance of the weight that arrives without specular reflection on the way
} olx_few_link;

// The links of one place at a time. Each thread has its own list.
typedef struct olx_link_list {
  olx_few_link *links;
  uint32_t count;
  uint32_t *places, surfels; // index of each surfel's link, or OLX_NO_LINK
  float *order;              // weights, for sorting
} olx_link_list;

#define OLX_NO_LINK UINT32_MAX

olx_result olx_link_list_create(olx_link_list *list, uint32_t surfels);
void olx_link_list_free(olx_link_list *list);

// Adds a link, merged with an existing one from `link->from`.
void olx_link_list_add(olx_link_list *list, const olx_few_link *link);

// Takes the links that were added, reduced to at most `most`, in the order in which their surfels were first added;
// `random` in [0, 1) drives systematic sampling with a threshold (Fearnhead and Clifford 2003). Returns their number
// and leaves the list empty.
uint32_t olx_link_list_take(olx_link_list *list, uint32_t most, float random, olx_few_link *links);

#endif
