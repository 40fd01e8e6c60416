// Checks counts in a file against olx_scene_limits before anything is allocated.
#ifndef OLX_SCENE_IMPORT_LIMITS_H
#define OLX_SCENE_IMPORT_LIMITS_H

#include "scene/scene_data.h"

// Returns the limits, with a default in place of every 0.
olx_scene_limits olx_import_limits(const olx_scene_limits *given);

typedef enum olx_import_limit {
  OLX_LIMIT_TRIANGLES,
  OLX_LIMIT_TEXELS,
  OLX_LIMIT_POLYGON_CORNERS,
  OLX_LIMIT_MATERIALS,
  OLX_LIMIT_NODES
} olx_import_limit;

// Fails when `found` is above the scene's limit. `path` is the file and `element` the position in it, such as
// "meshes[3]".
olx_result olx_import_check_limit(const olx_scene *scene, olx_import_limit limit, uint64_t found, const char *path,
                                  const char *element);

// Returns the total number of texels of the scene's images.
uint64_t olx_scene_texels(const olx_scene *scene);

#endif
