// Chooses the origin of a scene's local frame, and converts positions to that frame.
#include "scene/local_frame.h"

#include "core/chunk_file.h"

#define NEAR_DIAGONALS 16.0 // a scene within this many of its own diagonals of 0 keeps the origin 0

bool olx_scene_is_far(const olx_scene *scene) { return olx_origin_is_stored(scene->origin); }

olx_vec3 olx_scene_local(const olx_scene *scene, const double position[3]) {
  const double *o = scene->origin;
  return olx_v3((float)(position[0] - o[0]), (float)(position[1] - o[1]), (float)(position[2] - o[2]));
}

bool olx_scene_holds(const olx_scene *scene, olx_vec3 p) {
  const double *o = scene->origin;
  return fabs(o[0] + (double)p.x) <= OLX_POSITION_LIMIT_METRES &&
         fabs(o[1] + (double)p.y) <= OLX_POSITION_LIMIT_METRES && fabs(o[2] + (double)p.z) <= OLX_POSITION_LIMIT_METRES;
}

double olx_scene_length(const olx_scene *scene, double length) {
  return olx_scene_is_far(scene) ? length : (double)(float)length;
}

void olx_scene_include(olx_scene *scene, olx_vec3 position) {
  olx_box *made = &scene->made_of;
  made->min = scene->is_made ? olx_min_each(made->min, position) : position;
  made->max = scene->is_made ? olx_max_each(made->max, position) : position;
  scene->is_made = true;
}

bool olx_scene_wants_origin(const olx_scene *scene, double origin[3]) {
  if (!scene->is_made) return false;
  const olx_vec3 low = scene->made_of.min, high = scene->made_of.max;
  const double lows[3] = {(double)low.x, (double)low.y, (double)low.z};
  const double highs[3] = {(double)high.x, (double)high.y, (double)high.z};
  double squares = 0.0, farthest = 0.0;
  for (int axis = 0; axis < 3; axis++) {
    const double extent = highs[axis] - lows[axis], o = scene->origin[axis];
    squares += extent * extent;
    farthest = fmax(farthest, fmax(fabs(o + lows[axis]), fabs(o + highs[axis])));
  }
  const double diagonal = sqrt(squares);
  bool differs = false;
  int exponent;
  (void)frexp(diagonal, &exponent);
  const double step = ldexp(1.0, exponent);
  for (int axis = 0; axis < 3; axis++) {
    const double centre = scene->origin[axis] + 0.5 * (lows[axis] + highs[axis]);
    const bool far = diagonal > 0.0 && farthest > NEAR_DIAGONALS * diagonal;
    origin[axis] = far ? round(centre / step) * step + 0.0 : 0.0; // + 0.0 avoids -0
    differs = differs || origin[axis] != scene->origin[axis];
  }
  return differs;
}
