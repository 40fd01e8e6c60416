// glTF's materials as the scene has them.
#ifndef OLX_SCENE_GLTF_MATERIAL_H
#define OLX_SCENE_GLTF_MATERIAL_H

#include "scene/gltf_texture.h"

// What a primitive has to know of its material.
typedef struct olx_gltf_surface {
  uint32_t material; // of the scene
  bool used;         // a node of the file's scene leads to it
  bool absent;       // nothing of it is there
  olx_gltf_placements placements;
} olx_gltf_surface;

// Append the materials that are used, and their textures, to the scene. `surfaces` has one for each material and a last
// one for primitives without.
olx_result olx_gltf_import_materials(olx_gltf *gltf, olx_gltf_surface *surfaces);

#endif
