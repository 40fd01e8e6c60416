// KHR_materials_specular in terms of what a material holds: a specular weight w, with F0 = 0.04 w and F90 = w
// (docs/maths.md, "materials"). The extension's F0 is min(0.04 colour, 1) factor, and its F90 is the factor. So factors
// are exact; a colour contributes only its luminance, which then dims grazing reflections as well.
#ifndef OLX_SCENE_GLTF_SPECULAR_H
#define OLX_SCENE_GLTF_SPECULAR_H

#include "scene/import/texture_table.h"

// The images that determine a texel of a material with textures of the extension.
enum { OLX_SPECULAR_SURFACE, OLX_SPECULAR_FACTOR, OLX_SPECULAR_COLOR, OLX_SPECULAR_IMAGES };

// The extension of a material, and what its textures are merged from.
typedef struct olx_gltf_specular {
  olx_vec3 color;                       // specularColorFactor
  float factor;                         // specularFactor, 0 to 1
  uint32_t images[OLX_SPECULAR_IMAGES]; // of roughness and metallic, specularTexture, specularColorTexture: indices in
                                        // a table of textures, or OLX_NO_TEXTURE
} olx_gltf_specular;

// Returns the specular weight that gives F0 the luminance that it has by the extension, at most 1.
float olx_gltf_specular_weight(float factor, olx_vec3 color);

// Makes one texture of the images, which have been decoded, for a material that has the weight of the factors:
// roughness in G, metallic in B, the share of the weight in A. It is as wide and as high as the widest and the highest
// of them; where none could be read there is none. `element` names the material in errors.
olx_result olx_gltf_merge_specular(const olx_gltf_specular *specular, const olx_texture_table *images, const char *path,
                                   const char *element, olx_scene *scene, olx_material *material);

#endif
