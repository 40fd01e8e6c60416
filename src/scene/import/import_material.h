// Functions that the materials of all model files share: images beside the model, clamping of values, warnings.
#ifndef OLX_SCENE_IMPORT_MATERIAL_H
#define OLX_SCENE_IMPORT_MATERIAL_H

#include "scene/import/texture_table.h"

// Names of the materials that have one kind of problem, for a single warning about all of them.
typedef struct olx_name_list {
  uint32_t count;
  char names[200];
} olx_name_list;

void olx_name_list_add(olx_name_list *list, const char *name);

typedef struct olx_material_import {
  const char *path; // path of the model
  olx_scene *scene;
  olx_texture_table textures;
  olx_name_list clamped, repaired;
  olx_name_list blended;   // materials of partial opacity
  olx_name_list glazed;    // materials whose transmission is left out
  olx_name_list tinted;    // materials with a specular colour (KHR_materials_specular)
  olx_name_list displaced; // materials whose specular textures use other coordinates than their roughness texture
  olx_name_list crowded;   // materials whose textures use more than two placements of coordinates
} olx_material_import;

// Requests an image by its path relative to the model's; *number is its index in import->textures.
olx_result olx_import_texture_file(olx_material_import *import, const char *name, olx_texture_use use,
                                   uint32_t *number);

// Clamps the values of a material to their ranges. `repaired`: other numbers of it were clamped before.
void olx_import_repair_material(olx_material_import *import, olx_material *material, bool repaired);

// Loads the textures, and replaces indices of import->textures by the scene's in its materials from `first` on.
olx_result olx_import_load_textures(olx_material_import *import, uint32_t first);

void olx_import_warn_about_materials(const olx_material_import *import);

// Returns whether surfaces with this material are fully transparent, whatever its textures contain.
static inline bool olx_material_absent(const olx_material *material) {
  return material->blended ? !(material->alpha > 0.0f) : material->alpha < material->alpha_cutoff;
}

// Makes a material one of partial opacity, of which probes see only what is at least half opaque.
void olx_import_blend(olx_material_import *import, olx_material *material);

#endif
