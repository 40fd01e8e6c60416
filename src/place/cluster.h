// Grouping many places into few by likeness, one probe a group.
#ifndef OLX_PLACE_CLUSTER_H
#define OLX_PLACE_CLUSTER_H

#include "place/candidates.h"

// A place and what it is grouped by.
enum { OLX_FEATURES = 10 };
typedef struct olx_cluster_item {
  olx_vec3 place;
  float features[OLX_FEATURES]; // in diagonals of the scene
} olx_cluster_item;

// A cluster of fewer members than this share of the mean is dropped.
#define OLX_CLUSTER_LEAST 0.1
// Without a count there are as many clusters as it takes that no member is farther from its cluster's seed.
#define OLX_CLUSTER_REACH 0.15f

// Seeds that are farthest from each other, then Lloyd's k-means. cluster_of[i] < *clusters is item i's. `wanted` 0: by
// OLX_CLUSTER_REACH. At most `count` clusters, none empty.
olx_result olx_cluster(const olx_cluster_item *items, uint32_t count, uint32_t wanted, uint32_t threads,
                       uint32_t *cluster_of, uint32_t *clusters);

// The pinned probes, then one probe from each cluster, the largest first, `wanted` together (0: by OLX_CLUSTER_REACH):
// the member nearest to the cluster's mean that is not inside geometry and keeps its distance from the others. *probes
// is the caller's to release with olx_release.
olx_result olx_place_clusters(const olx_space *space, const olx_cluster_item *items, uint32_t count, uint32_t wanted,
                              uint32_t threads, olx_candidate **probes, uint32_t *probe_count);

#endif
