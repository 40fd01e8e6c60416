// A tree over surfels: what lies side by side in a cell, faces one way and sees each other is one node, so that a link may end
// at many surfels at once. Nothing on two sides of a wall is ever joined. Leaves are the surfels, by their numbers; nodes of
// more have the numbers after them, and members always have lower numbers than the node that they belong to.
#ifndef OLX_LIGHT_LINK_TREE_H
#define OLX_LIGHT_LINK_TREE_H

#include "light/light_bounces.h"
#include "light/light_surfels.h"

typedef struct olx_link_tree {
  uint32_t leaves, count;  // surfels; leaves and nodes of more
  uint32_t *parents;       // of each of `count`; OLX_TREE_NONE: none
  uint32_t *starts;        // of the members of node leaves + i, and the end
  uint32_t *members;       // numbers
  float *shares;           // of a member in its node's light; those of a node sum to 1
} olx_link_tree;

#define OLX_TREE_NONE UINT32_MAX

// Members count in a node by how often links end at them.
olx_result olx_link_tree_create(olx_link_tree *tree, const olx_light_surfels *surfels, const olx_light_links *links);
void olx_link_tree_free(olx_link_tree *tree);

// Light of all nodes from that of leaves: values[0 .. leaves) are given, the others filled in.
void olx_link_tree_sum(const olx_link_tree *tree, olx_vec3 *values);

#endif
