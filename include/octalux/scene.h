// Scenes: triangles, materials, lights, environment and cameras, from glTF, OBJ, JSON descriptions (docs/scenes.md) or
// built in. Right-handed, Y up, metres. Part of liboctalux-bake.
#ifndef OCTALUX_SCENE_H
#define OCTALUX_SCENE_H

#include <octalux/base.h>
#include <octalux/field.h>

#ifdef __cplusplus
extern "C" {
#endif
#pragma GCC visibility push(default)

typedef struct olx_scene olx_scene;

typedef struct olx_camera {
  char name[64];
  olx_vec3 eye, target, up;
  float fov_y_degrees; // vertical field of view
} olx_camera;

typedef struct olx_scene_info {
  uint64_t triangles, vertices;
  uint32_t materials, textures, lights, cameras;
  uint32_t warnings; // things skipped or clamped at import
  olx_vec3 bounds_min, bounds_max;
  bool has_probe_volume; // the description names probes.min and probes.max
  uint64_t hash;         // of geometry, materials, textures, lights and environment
} olx_scene_info;

// Load `name`: "builtin:NAME", or the path of a .gltf, .glb, .obj, .json or .olxs file. A model named by a description is looked
// for beside it and in each folder of the environment variable OCTALUX_SCENES. On success *scene is the caller's.
olx_result olx_scene_load(const char *name, olx_scene **scene);

// Write everything in a scene as one .olxs file (docs/cooked.md): beside, synced, renamed. It loads fast, has the same hash,
// and gives the same bakes and pictures to the last bit. file_bytes may be NULL.
olx_result olx_scene_cook(const olx_scene *scene, const char *path, uint64_t *file_bytes);
// Load an .olxs file. A program that loads scenes by this call alone needs Embree, but no importer's library.
olx_result olx_scene_load_cooked(const char *path, olx_scene **scene);

// NULL is allowed.
void olx_scene_free(olx_scene *scene);

olx_scene_info olx_scene_describe(const olx_scene *scene);

// What was skipped or clamped at import, index < warnings. Lives as long as the scene.
const char *olx_scene_warning(const olx_scene *scene, uint32_t index);

// index < cameras.
olx_camera olx_scene_camera(const olx_scene *scene, uint32_t index);

// The camera of that name; NULL asks for the first, or, in a scene without cameras, for one that sees the whole scene.
olx_result olx_scene_find_camera(const olx_scene *scene, const char *name, olx_camera *camera);

// The grid a bake uses: the description's probe volume, or the bounds inset by half a cell. `count` replaces the
// description's counts; NULL keeps them (4 x 4 x 4 when there are none).
olx_result olx_scene_probe_grid(const olx_scene *scene, const uint32_t count[3], olx_grid *grid);

// Names of the built-in scenes, index from 0; NULL past the last.
const char *olx_builtin_name(uint32_t index);

#pragma GCC visibility pop
#ifdef __cplusplus
}
#endif

#endif
