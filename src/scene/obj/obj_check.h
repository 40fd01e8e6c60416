// Checks of an OBJ file's text before Assimp reads it.
#ifndef OLX_SCENE_OBJ_CHECK_H
#define OLX_SCENE_OBJ_CHECK_H

#include "scene/scene_data.h"

// Rejects polygons, triangles and objects beyond the scene's limits. Missing material files, which Assimp silently
// ignores, become warnings of the scene.
olx_result olx_obj_check(const char *path, olx_scene *scene);

#endif
