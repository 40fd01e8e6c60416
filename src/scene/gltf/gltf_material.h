// Imports glTF materials into a scene.
#ifndef OLX_SCENE_GLTF_MATERIAL_H
#define OLX_SCENE_GLTF_MATERIAL_H

#include "scene/gltf/gltf_glossiness.h"
#include "scene/gltf/gltf_specular.h"
#include "scene/gltf/gltf_texture.h"
#include "scene/gltf/gltf_transmission.h"

// The properties of a material that its primitives depend on.
typedef struct olx_gltf_surface {
  uint32_t material;             // index in the scene
  bool used;                     // a node of the file's scene uses it
  bool absent;                   // fully transparent
  bool merged;                   // its textures of roughness, metallic and specular weight are merged
  bool converted;                // its textures are converted from KHR_materials_pbrSpecularGlossiness
  olx_gltf_specular specular;    // what the merged textures are made from
  olx_gltf_glossy_images glossy; // what the converted ones are made from
  olx_gltf_glass glass;          // what it transmits
  olx_gltf_placements placements;
} olx_gltf_surface;

// Appends the materials in use, and their textures, to the scene. `surfaces` has one element for each material, and a
// last one for primitives without a material.
olx_result olx_gltf_import_materials(olx_gltf *gltf, olx_gltf_surface *surfaces);

#endif
