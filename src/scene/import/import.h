// Fills a scene from files.
#ifndef OLX_SCENE_IMPORT_H
#define OLX_SCENE_IMPORT_H

#include "scene/scene_data.h"

// The placement of a model in the scene: scaled, then rotated about x, y, z in that order, then translated.
typedef struct olx_placement {
  float scale;
  double translate[3]; // in scene coordinates
  olx_vec3 rotate_degrees;
} olx_placement;

// Appends a glTF, GLB or OBJ model: triangles, materials, textures, lights and cameras.
olx_result olx_import_model(const char *path, const olx_placement *placement, olx_scene *scene);

// Appends a built-in scene, named without "builtin:": its triangles, materials, lights and cameras. Lights of points and
// spots grow with the square of the scale. A sky of its own replaces the scene's; its probe volume is not imported.
olx_result olx_import_builtin(const char *name, const olx_placement *placement, olx_scene *scene);

// Fills an empty scene from a JSON description (docs/scenes.md).
olx_result olx_import_description(const char *path, olx_scene *scene);

#endif
