// Tests whether a triangle touches a cube, by the separating axis theorem.
#ifndef OLX_SCENE_TRIANGLE_BOX_H
#define OLX_SCENE_TRIANGLE_BOX_H

#include "core/vec.h"

// Returns whether the axis separates the triangle (corners relative to the cube's centre) from the cube whose half side
// is `half`.
static inline bool olx_axis_separates(olx_vec3 axis, const olx_vec3 corners[3], float half) {
  const float a = olx_dot(axis, corners[0]), b = olx_dot(axis, corners[1]), c = olx_dot(axis, corners[2]);
  const float radius = half * (fabsf(axis.x) + fabsf(axis.y) + fabsf(axis.z));
  return olx_min(a, olx_min(b, c)) > radius || olx_max(a, olx_max(b, c)) < -radius;
}

// Returns whether no cross product of an edge of each separates them. The caller tests the cube's own axes and the
// triangle's normal.
static inline bool olx_triangle_edges_touch(const olx_vec3 corners[3], float half) {
  for (int i = 0; i < 3; i++) {
    const olx_vec3 e = olx_sub(corners[(i + 1) % 3], corners[i]);
    if (olx_axis_separates(olx_v3(0.0f, -e.z, e.y), corners, half) ||
        olx_axis_separates(olx_v3(e.z, 0.0f, -e.x), corners, half) ||
        olx_axis_separates(olx_v3(-e.y, e.x, 0.0f), corners, half)) {
      return false;
    }
  }
  return true;
}

static inline bool olx_triangle_touches_cube(const olx_vec3 corners[3], float half) {
  const olx_vec3 low = olx_min_each(corners[0], olx_min_each(corners[1], corners[2]));
  const olx_vec3 high = olx_max_each(corners[0], olx_max_each(corners[1], corners[2]));
  if (low.x > half || low.y > half || low.z > half || high.x < -half || high.y < -half || high.z < -half) return false;
  const olx_vec3 normal = olx_cross(olx_sub(corners[1], corners[0]), olx_sub(corners[2], corners[0]));
  return !olx_axis_separates(normal, corners, half) && olx_triangle_edges_touch(corners, half);
}

#endif
