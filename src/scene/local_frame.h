// The local frame of a scene's positions: relative to an origin in double precision, so that floats are as precise far
// from the origin of coordinates as near it (docs/maths.md, "Local frame").
#ifndef OLX_SCENE_LOCAL_FRAME_H
#define OLX_SCENE_LOCAL_FRAME_H

#include "scene/scene_data.h"

// Returns whether the origin is not 0.
bool olx_scene_is_far(const olx_scene *scene);

// Converts a position from scene coordinates to the local frame.
olx_vec3 olx_scene_local(const olx_scene *scene, const double position[3]);

// Returns whether a local position lies within OLX_POSITION_LIMIT_METRES of the origin of coordinates; false for NaN.
bool olx_scene_holds(const olx_scene *scene, olx_vec3 position);

// Converts a length read from a file: rounded to float in a scene whose origin is 0, like all of its positions.
double olx_scene_length(const olx_scene *scene, double length);

// Extends the bounds of the scene's content by a position.
void olx_scene_include(olx_scene *scene, olx_vec3 position);

// Returns whether the bounds of the scene's content require another origin than the scene has, and which.
bool olx_scene_wants_origin(const olx_scene *scene, double origin[3]);

#endif
