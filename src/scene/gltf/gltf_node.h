// The nodes of a glTF file: the trees that they form, and their transforms.
#ifndef OLX_SCENE_GLTF_NODE_H
#define OLX_SCENE_GLTF_NODE_H

#include "scene/affine.h"
#include "scene/gltf/gltf_document.h"

// The root nodes of a scene, or of the file where it has no scene.
typedef struct olx_gltf_roots {
  uint32_t *nodes;
  uint32_t count;
} olx_gltf_roots;

// Rejects nodes that form no forest, are nested too deeply, or name what does not exist, and finds the roots of the
// file's scene. The caller releases roots->nodes, also after a failure.
olx_result olx_gltf_find_roots(const olx_gltf *gltf, olx_gltf_roots *roots);

// Returns the transform of a node to its parent's space. Where the scene is far from the origin, translations keep the
// file's precision.
olx_affine olx_gltf_node_transform(const olx_gltf *gltf, uint32_t node);

// Calls `visit` for every node below the roots, parents before children, with its transform. Stops at the first
// failure.
olx_result olx_gltf_walk(const olx_gltf *gltf, const olx_gltf_roots *roots, const olx_affine *placement,
                         olx_result (*visit)(void *user, uint32_t node, const olx_affine *transform), void *user);

#endif
