// Checks of an OBJ file's text before Assimp reads it.
#ifndef OLX_SCENE_OBJ_CHECK_H
#define OLX_SCENE_OBJ_CHECK_H

#include "scene/scene_data.h"

// Refuse polygons, triangles and objects beyond the scene's limits. Material files that are missing become warnings of
// the scene, because Assimp passes over them in silence.
olx_result olx_obj_check(const char *path, olx_scene *scene);

#endif
