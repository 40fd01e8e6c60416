// Skins of glTF files: the joints that place the vertices of a mesh, as the file has them at rest. The transform of the
// mesh's own node does not count.
#ifndef OLX_SCENE_GLTF_SKIN_H
#define OLX_SCENE_GLTF_SKIN_H

#include "scene/affine.h"
#include "scene/gltf/gltf_document.h"

// The transform of a node to the scene; nodes outside the file's scene have none.
typedef struct olx_gltf_node_place {
  bool reached;
  olx_affine transform;
} olx_gltf_node_place;

// The transforms by which joints take a mesh to the scene. Zero until it is read.
typedef struct olx_gltf_skin {
  olx_affine *joints;
  uint32_t count;
} olx_gltf_skin;

// The accessors of a primitive's joints and weights.
typedef struct olx_gltf_bond {
  uint32_t joints, weights;
} olx_gltf_bond;

// Rejects skins without joints, and those whose joints or matrices do not exist or are of another type.
olx_result olx_gltf_check_skins(const olx_gltf *gltf);

// Reads a skin, whose joints must be in the scene. The caller releases skin->joints, also after a failure.
olx_result olx_gltf_read_skin(const olx_gltf *gltf, uint32_t index, const olx_gltf_node_place *nodes,
                              olx_gltf_skin *skin);

// Computes the transforms of vertices to the scene: the means of their joints' by weight. Vertices without usable
// weights follow their first joint and are added to *unweighted.
olx_result olx_gltf_pose_vertices(const olx_gltf *gltf, const olx_gltf_skin *skin, const olx_gltf_bond *bond,
                                  uint32_t vertices, olx_affine *places, uint32_t *unweighted);

#endif
