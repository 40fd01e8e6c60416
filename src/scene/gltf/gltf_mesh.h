// The meshes of a glTF file: validation, cost, and import of their triangles.
#ifndef OLX_SCENE_GLTF_MESH_H
#define OLX_SCENE_GLTF_MESH_H

#include "scene/gltf/gltf_material.h"
#include "scene/gltf/gltf_skin.h"
#include "scene/import/import_model.h"

// Rejects primitives whose accessors do not exist or whose elements do not match their attribute.
olx_result olx_gltf_check_meshes(const olx_gltf *gltf);

// Returns the cost of reading a mesh, in triangles: those of each primitive, or as many as its vertices would make, and
// at least one.
uint64_t olx_gltf_mesh_triangles(const olx_gltf *gltf, uint32_t mesh);

// Counts collected while meshes are added, for one warning of each kind.
typedef struct olx_gltf_mesh_notes {
  olx_model_notes model;
  uint32_t morphed;         // number of meshes with morph targets
  uint32_t lost_attributes; // attributes whose count differs from that of their positions
  uint32_t unweighted;      // vertices of skinned meshes without usable weights or joints
} olx_gltf_mesh_notes;

// How a mesh is placed.
typedef struct olx_gltf_pose {
  const olx_affine *transform; // of the node, or of a skin's first joint
  const olx_gltf_skin *skin;   // places the vertices that have joints; NULL: none
} olx_gltf_pose;

// Appends the triangles of a mesh.
olx_result olx_gltf_add_mesh(const olx_gltf *gltf, uint32_t mesh, const olx_gltf_surface *surfaces,
                             const olx_gltf_pose *pose, olx_gltf_mesh_notes *notes);

#endif
