// The scenes that are made by code.
#ifndef OLX_SCENE_BUILTIN_H
#define OLX_SCENE_BUILTIN_H

#include "scene/scene_data.h"

#define OLX_BUILTIN_PREFIX "builtin:"

// Fill an empty scene with the geometry, materials, lights, cameras and probe volume of a built-in scene.
olx_result olx_builtin_build(const char *name, olx_scene *scene);

#endif
