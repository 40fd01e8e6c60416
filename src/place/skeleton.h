// The skeleton of free space, from the distance transform and from shrinking balls (Wang 2018, section 3.1).
#ifndef OLX_PLACE_SKELETON_H
#define OLX_PLACE_SKELETON_H

#include "place/cluster.h"
#include "place/surfels.h"

// A ball that no surface enters and that touches two.
typedef struct olx_medial_ball {
  olx_vec3 centre;
  float radius;
  olx_vec3 normal; // of the surfel it was shrunk from: centre = surfel + radius * normal
  olx_vec3 other;  // the second surfel it touches
} olx_medial_ball;

// Far voxels: places whose distance no neighbour exceeds by more than half the way to it, and that are two voxels or
// more from surfaces (half the largest distance where space is narrower than that). At a ridge where two surfaces meet
// at a right angle the distance grows faster, so corners have no branches.
olx_result olx_far_voxels(const olx_space *space, olx_cluster_item **items, uint32_t *count);

// A ball for each surfel that has one (Ma et al. 2012): shrunk from half the way to what the surfel faces, until no
// other surfel is within. Those that a surface enters between the surfels, or that touch both surfels from nearly the
// same side, are dropped. *balls is the caller's to release with olx_release.
olx_result olx_medial_balls(const olx_space *space, const olx_surfels *surfels, uint32_t threads,
                            olx_medial_ball **balls, uint32_t *count);
// Finds medial balls for as many surfels as the settings have, spread by area.
olx_result olx_area_balls(const olx_space *space, const olx_sight *sight, const olx_place_settings *settings,
                          olx_medial_ball **balls, uint32_t *count);

// Probes from clusters of far voxels, `wanted` in all, the pinned ones included; 0: as many as olx_cluster finds.
olx_result olx_place_sdf(const olx_space *space, uint32_t wanted, uint32_t threads, olx_candidate **probes,
                         uint32_t *probe_count, uint32_t *candidates);
// Places probes from clusters of medial balls, grouped by position, normal and radius.
olx_result olx_place_medial(const olx_space *space, const olx_sight *sight, const olx_place_settings *settings,
                            olx_candidate **probes, uint32_t *probe_count, uint32_t *candidates);

#endif
