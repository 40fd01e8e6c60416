// Textures of glTF materials: their images, and where their coordinates come from.
#ifndef OLX_SCENE_GLTF_TEXTURE_H
#define OLX_SCENE_GLTF_TEXTURE_H

#include "scene/gltf_document.h"
#include "scene/import_material.h"

// A set of texture coordinates (TEXCOORD_n), and what KHR_texture_transform makes of it: (u, v, 1) times two rows.
typedef struct olx_gltf_placement {
  uint32_t set;
  float rows[2][3];
} olx_gltf_placement;

// Which coordinates a material's textures use: two of them at most, which become the vertices' uvs and second_uvs.
typedef struct olx_gltf_placements {
  uint32_t count;
  olx_gltf_placement places[2];
} olx_gltf_placements;

// How a texture of a material is placed.
olx_gltf_placement olx_gltf_read_placement(const cJSON *info);

// The placement's number, which is added when it is new; false when there are two others.
bool olx_gltf_find_placement(olx_gltf_placements *placements, const olx_gltf_placement *place, uint32_t *number);

olx_vec2 olx_gltf_place_uv(const olx_gltf_placement *place, olx_vec2 uv);

// Ask for the image of texture `texture`: its number in import->textures, or OLX_NO_TEXTURE where it names none.
// OLX_ERROR_UNSUPPORTED when all it names is an image of an extension's kind.
olx_result olx_gltf_request_texture(olx_gltf *gltf, olx_material_import *import, uint32_t texture, olx_texture_use use,
                                    uint32_t *number);

void olx_gltf_release_images(olx_gltf *gltf);

#endif
