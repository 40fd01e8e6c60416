// Decides whether positions are buried (inside geometry), in scenes whose meshes may be open, two-sided or inside out.
#ifndef OLX_PLACE_INSIDE_H
#define OLX_PLACE_INSIDE_H

#include "scene/scene_data.h"

// How deep a position is inside surfaces.
typedef struct olx_depth {
  float back_share; // share of all directions that hit the back of a triangle first
  float sky_share;  // share of all directions that hit nothing
  int32_t depth;    // back faces minus front faces crossed until the ray leaves the scene, the median over many
                    // directions
  uint32_t rays;    // rays cast
} olx_depth;

// Returns whether a triangle that a ray hits faces away from it, by its winding.
bool olx_faces_away(const olx_scene *scene, uint32_t triangle, olx_vec3 direction);

// Measures the depth of each position.
olx_result olx_measure_depth(const olx_scene *scene, const olx_vec3 *positions, uint32_t count, uint32_t threads,
                             olx_depth *depths);

// Finds the depth of a position that is inside nothing: the least depth of positions known to be free, which are the
// scene's cameras and what they see, or without cameras the box for probes. It depends on the scene alone, so that
// placement and baking agree on which positions are buried. A room whose walls all face outwards shifts the depth of
// every position in it by the same amount. Adds the rays cast to *rays, which may be NULL.
olx_result olx_find_outside(const olx_scene *scene, uint32_t threads, int32_t *outside, uint64_t *rays);

// A position is inside geometry when it sees mostly back faces *and* lies deeper than `outside` (olx_find_outside).
// Neither suffices alone: behind an open sheet most faces are back faces, but the depth is the same; outside a room the
// depth is greater than in it, but front faces and sky are visible.
static inline bool olx_depth_is_inside(olx_depth d, int32_t outside) {
  return d.back_share > 0.5f && d.depth > outside;
}
// A position is behind the scenery when what it sees besides the sky is mostly back faces and it lies deeper than
// `outside`. This is also the case between the outside of a wall and the end of the scene.
static inline bool olx_depth_is_behind(olx_depth d, int32_t outside) {
  return d.back_share > 0.5f * (1.0f - d.sky_share) && d.depth > outside;
}

#endif
