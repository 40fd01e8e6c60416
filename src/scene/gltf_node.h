// The nodes of a glTF file: the trees they form, and where they put what they carry.
#ifndef OLX_SCENE_GLTF_NODE_H
#define OLX_SCENE_GLTF_NODE_H

#include "scene/affine.h"
#include "scene/gltf_document.h"

// Nodes that lie on top of a scene, or of the file where it has no scene.
typedef struct olx_gltf_roots {
  uint32_t *nodes;
  uint32_t count;
} olx_gltf_roots;

// Refuse nodes that form no forest or are nested too deep, and find the roots of the file's scene. The caller releases
// roots->nodes, whatever comes back.
olx_result olx_gltf_find_roots(const olx_gltf *gltf, olx_gltf_roots *roots);

// Where a node puts things in its parent's space. Translations are as exact as the file has them where the scene is far
// from the origin.
olx_affine olx_gltf_node_transform(const olx_gltf *gltf, uint32_t node);

// Calls `visit` for every node below the roots, parents before children, with what places it. Stops at the first
// failure.
olx_result olx_gltf_walk(const olx_gltf *gltf, const olx_gltf_roots *roots, const olx_affine *placement,
                         olx_result (*visit)(void *user, uint32_t node, const olx_affine *transform), void *user);

#endif
