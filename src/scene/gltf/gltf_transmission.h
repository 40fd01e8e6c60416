// KHR_materials_transmission in terms of what a material holds: light that a thin surface transmits is missing opacity.
// Its base colour tints that light, of which the mean counts, and metal transmits nothing.
#ifndef OLX_SCENE_GLTF_TRANSMISSION_H
#define OLX_SCENE_GLTF_TRANSMISSION_H

#include "scene/scene_data.h"

// The images that determine the opacity of a texel: of base colours, and of metalness in B.
enum { OLX_GLASS_COLOR, OLX_GLASS_METAL, OLX_GLASS_IMAGES };

// The extension of a material.
typedef struct olx_gltf_glass {
  float transmission;                // transmissionFactor, 0 to 1; 0: the surface transmits nothing
  bool keeps_alpha;                  // the alpha of its base colour's texture counts, as BLEND has it
  olx_vec3 color;                    // baseColorFactor, before it is clamped
  float metallic;                    // metallicFactor
  uint32_t images[OLX_GLASS_IMAGES]; // textures of the scene, or OLX_NO_TEXTURE
} olx_gltf_glass;

// Completes what determines the opacity of a material by its factors and textures, which are final.
void olx_gltf_find_glass(const olx_material *material, olx_gltf_glass *glass);

// Returns whether two materials with textures have the same texture of opacity.
bool olx_gltf_same_glass(const olx_gltf_glass *a, const olx_gltf_glass *b);

// Gives a material the opacity of its factors, or a texture of base colours with the opacity of each texel in its alpha
// where it has textures of base colours or metalness. `element` names the material in errors.
olx_result olx_gltf_apply_glass(const olx_gltf_glass *glass, const char *path, const char *element, olx_scene *scene,
                                olx_material *material);

// Gives a material the texture of opacity that another one, `made`, got by the same glass.
void olx_gltf_share_glass(const olx_gltf_glass *glass, const olx_material *made, olx_material *material);

#endif
