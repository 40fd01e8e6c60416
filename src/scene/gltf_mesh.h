// The meshes of a glTF file: what may be in them, what they cost, and their triangles.
#ifndef OLX_SCENE_GLTF_MESH_H
#define OLX_SCENE_GLTF_MESH_H

#include "scene/gltf_material.h"
#include "scene/import_model.h"

// Refuse primitives whose accessors do not exist or have elements of another kind than their attribute.
olx_result olx_gltf_check_meshes(const olx_gltf *gltf);

// What a mesh costs to read, in triangles: those of each primitive, or as many as its vertices would make, and one at
// least.
uint64_t olx_gltf_mesh_triangles(const olx_gltf *gltf, uint32_t mesh);

// What is noted while meshes are added, for one warning of each kind.
typedef struct olx_gltf_mesh_notes {
  olx_model_notes model;
  uint32_t morphed;         // meshes with morph targets
  uint32_t lost_attributes; // attributes with other counts than their positions
} olx_gltf_mesh_notes;

// Append the triangles of a mesh.
olx_result olx_gltf_add_mesh(const olx_gltf *gltf, uint32_t mesh, const olx_gltf_surface *surfaces,
                             const olx_affine *transform, olx_gltf_mesh_notes *notes);

#endif
