// The skeleton of free space, from the distance transform and from shrinking balls (Wang 2018, section 3.1).
#ifndef OLX_PLACE_SKELETON_H
#define OLX_PLACE_SKELETON_H

#include "place/cover/surfels.h"
#include "place/skeleton/cluster.h"

// A ball that no surface enters and that touches two surfels.
typedef struct olx_medial_ball {
  olx_vec3 centre;
  float radius;
  olx_vec3 normal; // of the surfel from which it was shrunk: centre = surfel + radius * normal
  olx_vec3 other;  // the second surfel that it touches
} olx_medial_ball;

// Finds far voxels: those whose distance to surfaces no neighbour exceeds by more than half the step to it, and that
// are two voxels or more from surfaces (half the largest distance where space is narrower). Distances at the bisector
// of a right angle grow faster, so that corners have no branches.
olx_result olx_far_voxels(const olx_space *space, olx_cluster_item **items, uint32_t *count);

// Finds a ball for each surfel that has one (Ma et al. 2012): shrunk from half the distance to what the surfel faces,
// until it contains no other surfel. Balls that a surface enters between the surfels, or that touch both surfels from
// nearly the same side, are dropped. The caller releases *balls with olx_release.
olx_result olx_medial_balls(const olx_space *space, const olx_surfels *surfels, uint32_t threads,
                            olx_medial_ball **balls, uint32_t *count);
// Finds medial balls for as many surfels as the settings request, spread by area.
olx_result olx_area_balls(const olx_space *space, const olx_sight *sight, const olx_place_settings *settings,
                          olx_medial_ball **balls, uint32_t *count);

// Places probes from clusters of far voxels, `wanted` in total, including the pinned ones; 0: as many as olx_cluster
// finds.
olx_result olx_place_sdf(const olx_space *space, uint32_t wanted, uint32_t threads, olx_candidate **probes,
                         uint32_t *probe_count, uint32_t *candidates);
// Places probes from clusters of medial balls, grouped by position, normal and radius.
olx_result olx_place_medial(const olx_space *space, const olx_sight *sight, const olx_place_settings *settings,
                            olx_candidate **probes, uint32_t *probe_count, uint32_t *candidates);

#endif
