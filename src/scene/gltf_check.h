// Checks of a glTF file's JSON before Assimp reads it.
#ifndef OLX_SCENE_GLTF_CHECK_H
#define OLX_SCENE_GLTF_CHECK_H

#include "scene/json_value.h"
#include "scene/scene_data.h"

// Refuse versions and required extensions that are not supported, indices out of range, accessors that reach past their
// buffers, nodes that are no forest, and more of anything than the scene's limits. Ignored extensions become warnings of the scene.
olx_result olx_gltf_check(const char *path, const cJSON *root, olx_scene *scene);

#endif
