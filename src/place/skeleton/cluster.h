// Groups many positions into few clusters by similarity, with one probe per cluster.
#ifndef OLX_PLACE_CLUSTER_H
#define OLX_PLACE_CLUSTER_H

#include "place/cover/candidates.h"

// A position and the features that it is grouped by.
enum { OLX_FEATURES = 10 };
typedef struct olx_cluster_item {
  olx_vec3 place;
  float features[OLX_FEATURES]; // in units of the scene's diagonal
} olx_cluster_item;

// A cluster with fewer members than this share of the mean is dropped.
#define OLX_CLUSTER_LEAST 0.1
// Without a requested count, clusters are added until no member is farther than this from its cluster's seed.
#define OLX_CLUSTER_REACH 0.15f

// Clusters items by seeds that are farthest from each other, then Lloyd's k-means. cluster_of[i] < *clusters is item
// i's cluster. `wanted` 0: as many as OLX_CLUSTER_REACH requires. At most `count` clusters, none empty.
olx_result olx_cluster(const olx_cluster_item *items, uint32_t count, uint32_t wanted, uint32_t threads,
                       uint32_t *cluster_of, uint32_t *clusters);

// Places the pinned probes, then one probe from each cluster, the largest first, `wanted` in total (0: by
// OLX_CLUSTER_REACH): the member nearest to the cluster's mean that is not buried (inside geometry) and keeps its
// distance from the others. The caller releases *probes with olx_release.
olx_result olx_place_clusters(const olx_space *space, const olx_cluster_item *items, uint32_t count, uint32_t wanted,
                              uint32_t threads, olx_candidate **probes, uint32_t *probe_count);

#endif
