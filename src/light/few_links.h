// Makes many links few: those to the same surfel become one, and of more than there is room for the heaviest stay as
// they are while of the others some are drawn, which then stand for all of them. No light is lost or gained on average.
#ifndef OLX_LIGHT_FEW_LINKS_H
#define OLX_LIGHT_FEW_LINKS_H

#include "core/vec.h"

#include <octalux/base.h>

typedef struct olx_few_link {
  uint32_t from;      // a surfel
  olx_vec3 weight;    // of its irradiance in what arrives
  olx_vec3 direction; // towards it: the mean of what was added, times its weights' luminance
  float straight;     // luminance of the weight that no specular surface passed on
} olx_few_link;

// Links of one place at a time. Each thread has its own.
typedef struct olx_link_list {
  olx_few_link *links;
  uint32_t count;
  uint32_t *places, surfels; // of each surfel: its link's number; OLX_NO_LINK
  float *order;              // weights, to sort by
} olx_link_list;

#define OLX_NO_LINK UINT32_MAX

olx_result olx_link_list_create(olx_link_list *list, uint32_t surfels);
void olx_link_list_free(olx_link_list *list);

// Adds to the link from `link->from`.
void olx_link_list_add(olx_link_list *list, const olx_few_link *link);

// Takes the links that were added, reduced to at most `most`, in the order in which surfels were named; `random` in [0,
// 1) draws (systematic sampling with a threshold: Fearnhead and Clifford 2003). Returns how many, and leaves the list
// empty.
uint32_t olx_link_list_take(olx_link_list *list, uint32_t most, float random, olx_few_link *links);

#endif
