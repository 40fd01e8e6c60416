// EXT_mesh_gpu_instancing: nodes whose mesh stands in many places, as `gltfpack -mi` and glTF-Transform write them. The
// node's attributes TRANSLATION, ROTATION and SCALE have one element for each place; those that are missing change
// nothing, and others are ignored. Children of the node, its camera and its light stand in one place.
#ifndef OLX_SCENE_GLTF_INSTANCES_H
#define OLX_SCENE_GLTF_INSTANCES_H

#include "scene/affine.h"
#include "scene/gltf/gltf_document.h"

// Rejects nodes whose attributes do not exist, are of other types than the extension has, or differ in their count.
olx_result olx_gltf_check_instances(const olx_gltf *gltf);

// Returns the number of places in which the mesh of a node stands: 1 without the extension.
uint32_t olx_gltf_instance_count(const olx_gltf *gltf, uint32_t node);

// Reads the transforms of a node's places to the node's own space. `transforms` has room for all.
olx_result olx_gltf_read_instances(const olx_gltf *gltf, uint32_t node, olx_affine *transforms);

#endif
