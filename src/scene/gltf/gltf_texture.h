// Textures of glTF materials: their images, and the transforms of their coordinates.
#ifndef OLX_SCENE_GLTF_TEXTURE_H
#define OLX_SCENE_GLTF_TEXTURE_H

#include "scene/gltf/gltf_document.h"
#include "scene/import/import_material.h"

// A set of texture coordinates (TEXCOORD_n) and its KHR_texture_transform: (u, v, 1) times two rows.
typedef struct olx_gltf_placement {
  uint32_t set;
  float rows[2][3];
} olx_gltf_placement;

// The placements that a material's textures use: at most two, which become the vertices' uvs and second_uvs.
typedef struct olx_gltf_placements {
  uint32_t count;
  olx_gltf_placement places[2];
} olx_gltf_placements;

// Reads how a texture of a material is placed.
olx_gltf_placement olx_gltf_read_placement(const cJSON *info);

bool olx_gltf_same_placement(const olx_gltf_placement *a, const olx_gltf_placement *b);

// Finds the index of the placement, which is added when it is new; false when there are two others.
bool olx_gltf_find_placement(olx_gltf_placements *placements, const olx_gltf_placement *place, uint32_t *number);

olx_vec2 olx_gltf_place_uv(const olx_gltf_placement *place, olx_vec2 uv);

// Requests the image of texture `texture`: *number is its index in import->textures, or OLX_NO_TEXTURE where it has
// none, which becomes a warning. Returns OLX_ERROR_UNSUPPORTED when it names only an image of an extension's kind.
olx_result olx_gltf_request_texture(olx_gltf *gltf, olx_material_import *import, uint32_t texture, olx_texture_use use,
                                    uint32_t *number);

// Rejects textures whose sampler does not exist, and warns about those that it mirrors where they repeat.
olx_result olx_gltf_check_samplers(const olx_gltf *gltf);

void olx_gltf_release_images(olx_gltf *gltf);

#endif
