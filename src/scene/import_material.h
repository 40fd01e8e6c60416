// What the materials of all model files have in common: images beside the model, numbers to repair, warnings.
#ifndef OLX_SCENE_IMPORT_MATERIAL_H
#define OLX_SCENE_IMPORT_MATERIAL_H

#include "scene/texture_table.h"

// Names of materials in which one kind of trouble was met, for one warning about all of them.
typedef struct olx_name_list {
  uint32_t count;
  char names[200];
} olx_name_list;

void olx_name_list_add(olx_name_list *list, const char *name);

typedef struct olx_material_import {
  const char *path; // of the model
  olx_scene *scene;
  olx_texture_table textures;
  olx_name_list clamped, repaired, translucent;
  olx_name_list half_specular; // more of KHR_materials_specular than its factor
  olx_name_list crowded;       // textures with more than two kinds of coordinates
} olx_material_import;

// Ask for an image that the model names by a path relative to its own; *number is that of import->textures.
olx_result olx_import_texture_file(olx_material_import *import, const char *name, olx_texture_use use,
                                   uint32_t *number);

// Bring the numbers of a material into their ranges.
void olx_import_repair_material(olx_material_import *import, olx_material *material);

// Load the textures, and give the scene's materials from `first` on their indices in place of the numbers of
// import->textures.
olx_result olx_import_load_textures(olx_material_import *import, uint32_t first);

void olx_import_warn_about_materials(const olx_material_import *import);

// Whether nothing of a surface with this material is there, whatever its textures say.
static inline bool olx_material_absent(const olx_material *material) {
  return material->alpha < material->alpha_cutoff;
}

#endif
