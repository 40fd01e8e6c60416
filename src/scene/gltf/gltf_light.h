// Imports cameras and KHR_lights_punctual of glTF nodes.
#ifndef OLX_SCENE_GLTF_LIGHT_H
#define OLX_SCENE_GLTF_LIGHT_H

#include "scene/affine.h"
#include "scene/gltf/gltf_document.h"

// Appends the camera, or the light, of a node to the scene. Invalid ones are left out with a warning.
olx_result olx_gltf_add_camera(const olx_gltf *gltf, uint32_t node, const olx_affine *transform);
void olx_gltf_add_light(const olx_gltf *gltf, uint32_t node, const olx_affine *transform);

#endif
