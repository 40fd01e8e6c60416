// Turning Assimp's materials into ours.
#ifndef OLX_SCENE_IMPORT_MATERIAL_H
#define OLX_SCENE_IMPORT_MATERIAL_H

#include "scene/gltf_json.h"
#include "scene/texture_table.h"

#include <assimp/scene.h>

// Names of materials in which one kind of trouble was met, for one warning about all of them.
typedef struct olx_name_list {
  uint32_t count;
  char names[200];
} olx_name_list;

void olx_name_list_add(olx_name_list *list, const char *name);

typedef struct olx_material_import {
  const char *path; // of the model
  const olx_scene *scene;
  const struct aiScene *source;
  const olx_gltf *gltf; // NULL for OBJ
  olx_texture_table textures;
  olx_name_list clamped, repaired, translucent, mixed_uvs;
} olx_material_import;

// Material `index` of the source; its texture members are numbers of import->textures. *uv_set is the set of texture
// coordinates its textures use.
olx_result olx_import_material(olx_material_import *import, uint32_t index, olx_material *material, uint32_t *uv_set);

// Whether nothing of a surface with this material is there, whatever its textures say.
static inline bool olx_material_absent(const olx_material *material) {
  return material->alpha < material->alpha_cutoff;
}

#endif
