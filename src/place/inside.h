// Whether places are inside geometry, in scenes whose meshes may be open, two-sided or turned inside out.
#ifndef OLX_PLACE_INSIDE_H
#define OLX_PLACE_INSIDE_H

#include "scene/scene_data.h"

// How deep a place is inside surfaces.
typedef struct olx_depth {
  float back_share; // of all directions, that meet the back of a triangle first
  float sky_share;  // that meet nothing
  int32_t depth;    // back faces minus front faces crossed on the way out, the median over many directions
  uint32_t rays;    // cast to find out
} olx_depth;

// Whether the triangle's winding faces away from a ray that meets it.
bool olx_faces_away(const olx_scene *scene, uint32_t triangle, olx_vec3 direction);

// Measure each position.
olx_result olx_measure_depth(const olx_scene *scene, const olx_vec3 *positions, uint32_t count, uint32_t threads,
                             olx_depth *depths);

// The depth of a place that is inside nothing: the least among what is known to be free. That is what the scene's
// cameras see and where they are; without cameras it is the box where probes go. It depends on the scene alone, so that
// placing and baking mean the same by a place inside geometry. A room whose walls all face outwards shifts the depth of
// every place in it alike. Adds the rays cast to *rays, which may be NULL.
olx_result olx_find_outside(const olx_scene *scene, uint32_t threads, int32_t *outside, uint64_t *rays);

// A place is inside when it sees mostly back faces *and* lies deeper than `outside` (olx_find_outside).
// Neither suffices alone: behind an open sheet one sees back faces but lies no deeper, and outside a room one
// lies deeper by the count than in it but sees fronts and sky.
static inline bool olx_depth_is_inside(olx_depth d, int32_t outside) {
  return d.back_share > 0.5f && d.depth > outside;
}
// A place is behind the scenery when what it sees beside the sky is mostly back faces and it lies deeper than
// `outside`. That holds also between the outside of a wall and the end of the scene.
static inline bool olx_depth_is_behind(olx_depth d, int32_t outside) {
  return d.back_share > 0.5f * (1.0f - d.sky_share) && d.depth > outside;
}

#endif
