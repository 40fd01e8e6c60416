// A ball that is not in the scene: it casts shadows and receives light, but is in no probe (McGuire et al. 2017, Figure
// 16).
#ifndef OCTALUX_VIEW_OBJECT_H
#define OCTALUX_VIEW_OBJECT_H

#include "scene_upload.h"
#include "view_state.h"

// Creates the ball, of radius 1 around the origin.
bool view_object_create(gpu_device *device, float roughness, float metallic, gpu_scene *object);

// Returns the object, placed by the state.
draw_item view_object_place(const gpu_scene *object, const view_state *state);

#endif
