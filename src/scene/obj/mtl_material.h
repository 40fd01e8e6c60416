// Converts the materials of OBJ models.
#ifndef OLX_SCENE_MTL_MATERIAL_H
#define OLX_SCENE_MTL_MATERIAL_H

#include "scene/import/import_material.h"

struct aiMaterial;

// Converts one of Assimp's materials; its texture members are indices of import->textures.
olx_result olx_import_mtl(olx_material_import *import, const struct aiMaterial *source, olx_material *material);

// Finishes a material whose textures are loaded: `map_Ke` without `Ke` has a factor of 1.
void olx_finish_mtl(olx_material *material);

#endif
