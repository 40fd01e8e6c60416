// KHR_materials_pbrSpecularGlossiness in terms of what a material holds. The extension gives a surface a diffuse colour,
// a reflectance F0 of any colour, and a glossiness; a material here is a mix of a dielectric, whose F0 is at most 0.04,
// and of a metal, whose F0 is its base colour.
#ifndef OLX_SCENE_GLTF_GLOSSINESS_H
#define OLX_SCENE_GLTF_GLOSSINESS_H

#include "scene/import/texture_table.h"

// What the extension says of a surface: factors, or their products with texels.
typedef struct olx_gltf_glossiness {
  olx_vec3 diffuse, specular;
  float glossiness;
} olx_gltf_glossiness;

typedef struct olx_gltf_converted {
  olx_vec3 base_color;
  float metallic, roughness, specular_weight;
} olx_gltf_converted;

// Converts a surface: one that reflects at most 0.04 is a dielectric, exactly; any other is the mix with a metal that
// has the luminance of its diffuse and of its specular reflectance.
olx_gltf_converted olx_gltf_convert_glossiness(const olx_gltf_glossiness *surface);

// The images that a material's texels are converted from: indices in a table of textures, or OLX_NO_TEXTURE.
typedef struct olx_gltf_glossy_images {
  olx_gltf_glossiness factors;
  uint32_t diffuse, specular; // diffuse: its alpha stays; specular: glossiness in A
} olx_gltf_glossy_images;

// Makes a texture of base colours and one of roughness, metallic and specular weight from the images, which have been
// decoded, and gives them to the material, whose own numbers then multiply nothing. Where no image could be read the
// material stays as it is. `element` names the material in errors.
olx_result olx_gltf_merge_glossiness(const olx_gltf_glossy_images *images, const olx_texture_table *table,
                                     const char *path, const char *element, olx_scene *scene, olx_material *material);

#endif
