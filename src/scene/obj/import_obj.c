// Imports OBJ models, which Assimp reads after the file has been checked.
#include "core/hooks.h"
#include "core/result.h"
#include "scene/import/import_model.h"
#include "scene/import/model_files.h"
#include "scene/obj/mtl_material.h"
#include "scene/obj/obj_check.h"
#include "scene/scene_build.h"

#include <assimp/cimport.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <stdio.h>

typedef struct obj_import {
  const char *path;
  olx_scene *scene;
  const struct aiScene *source;
  uint32_t *material_index; // scene index of each source material; UINT32_MAX when no mesh uses it
  bool *absent;             // one per source material
  olx_model_notes notes;
  uint32_t colored_meshes;
} obj_import;

// Sets material_index to 0 for materials that a mesh uses, and to UINT32_MAX for the others.
static void mark_used_materials(obj_import *import) {
  const struct aiScene *source = import->source;
  for (uint32_t i = 0; i < source->mNumMaterials; ++i) import->material_index[i] = UINT32_MAX;
  for (uint32_t i = 0; i < source->mNumMeshes; ++i) {
    const uint32_t material = source->mMeshes[i]->mMaterialIndex;
    if (material < source->mNumMaterials) import->material_index[material] = 0;
  }
}

static olx_result add_materials(obj_import *import, olx_material_import *materials) {
  const struct aiScene *source = import->source;
  const uint32_t first = import->scene->material_count;
  mark_used_materials(import);
  for (uint32_t i = 0; i < source->mNumMaterials; ++i) {
    if (import->material_index[i] == UINT32_MAX) continue;
    olx_material material;
    OLX_TRY(olx_import_mtl(materials, source->mMaterials[i], &material));
    import->absent[i] = olx_material_absent(&material);
    OLX_TRY(olx_scene_add_material(import->scene, &material, &import->material_index[i]));
  }
  OLX_TRY(olx_import_load_textures(materials, first));
  for (uint32_t i = first; i < import->scene->material_count; ++i) olx_finish_mtl(&import->scene->materials[i]);
  olx_import_warn_about_materials(materials);
  return OLX_OK;
}

static olx_result import_materials(obj_import *import) {
  olx_material_import materials = {.path = import->path, .scene = import->scene};
  const olx_result result = add_materials(import, &materials);
  olx_texture_table_free(&materials.textures);
  return result;
}

// The arrays of one mesh, in the form that olx_scene_add_mesh takes.
typedef struct mesh_arrays {
  olx_vec3 *positions, *normals;
  olx_vec2 *uvs;
  uint32_t *indices;
  uint32_t triangle_count;
} mesh_arrays;

static void fill_vertices(obj_import *import, const struct aiMesh *mesh, const olx_affine *transform,
                          mesh_arrays *out) {
  const olx_affine normals = olx_affine_normals(transform);
  const double mirrored = olx_affine_determinant(transform) < 0.0 ? -1.0 : 1.0;
  float farthest = 0.0f;
  for (uint32_t i = 0; i < mesh->mNumVertices; ++i) {
    const struct aiVector3D p = mesh->mVertices[i];
    farthest = olx_max(farthest, olx_max3(olx_v3(fabsf(p.x), fabsf(p.y), fabsf(p.z))));
    out->positions[i] = olx_affine_point(transform, olx_v3(p.x, p.y, p.z));
    if (out->normals) {
      const struct aiVector3D n = mesh->mNormals[i];
      const olx_vec3 turned = olx_affine_vector(&normals, olx_normalize(olx_v3(n.x, n.y, n.z)));
      out->normals[i] = olx_scale(turned, (float)mirrored);
    }
    // Assimp's v increases upwards from the bottom of the image, while the scene's increases downwards from its top.
    if (out->uvs) out->uvs[i] = (olx_vec2){mesh->mTextureCoords[0][i].x, 1.0f - mesh->mTextureCoords[0][i].y};
  }
  olx_note_farthest(&import->notes, farthest, transform);
}

// Fills the indices of triangles; a mirroring transform reverses them, so that front faces stay front faces.
static void fill_indices(obj_import *import, const struct aiMesh *mesh, bool mirrored, mesh_arrays *out) {
  uint32_t *index = out->indices;
  for (uint32_t i = 0; i < mesh->mNumFaces; ++i) {
    const struct aiFace *face = &mesh->mFaces[i];
    if (face->mNumIndices != 3) {
      ++import->notes.thin_faces;
      continue;
    }
    *index++ = face->mIndices[0];
    *index++ = face->mIndices[mirrored ? 2 : 1];
    *index++ = face->mIndices[mirrored ? 1 : 2];
    ++out->triangle_count;
  }
}

static void free_arrays(mesh_arrays *arrays) {
  olx_release(arrays->positions);
  olx_release(arrays->normals);
  olx_release(arrays->uvs);
  olx_release(arrays->indices);
}

static olx_result add_mesh_arrays(obj_import *import, const struct aiMesh *mesh, const olx_affine *transform,
                                  mesh_arrays *out) {
  const bool uvs = mesh->mTextureCoords[0] != NULL;
  out->positions = olx_allocate(mesh->mNumVertices, sizeof *out->positions);
  out->normals = mesh->mNormals ? olx_allocate(mesh->mNumVertices, sizeof *out->normals) : NULL;
  out->uvs = uvs ? olx_allocate(mesh->mNumVertices, sizeof *out->uvs) : NULL;
  out->indices = olx_allocate(mesh->mNumFaces, 3 * sizeof *out->indices);
  if (!out->positions || !out->indices || (mesh->mNormals && !out->normals) || (uvs && !out->uvs)) {
    return olx_fail(OLX_ERROR_MEMORY, "%s: out of memory for mesh \"%.100s\"", import->path, mesh->mName.data);
  }
  fill_vertices(import, mesh, transform, out);
  fill_indices(import, mesh, olx_affine_determinant(transform) < 0.0, out);
  char name[2048];
  snprintf(name, sizeof name, "%.1024s: mesh \"%.100s\"", import->path, mesh->mName.data);
  return olx_scene_add_mesh(import->scene, name, out->positions, out->normals, out->uvs, mesh->mNumVertices,
                            out->indices, out->triangle_count, import->material_index[mesh->mMaterialIndex]);
}

static olx_result add_mesh(obj_import *import, const struct aiMesh *mesh, const olx_affine *transform) {
  if (!mesh->mVertices || mesh->mMaterialIndex >= import->source->mNumMaterials) return OLX_OK;
  if (import->absent[mesh->mMaterialIndex]) {
    import->notes.absent_triangles += mesh->mNumFaces;
    return OLX_OK;
  }
  import->colored_meshes += mesh->mColors[0] != NULL;
  mesh_arrays arrays = {0};
  const olx_result result = add_mesh_arrays(import, mesh, transform, &arrays);
  free_arrays(&arrays);
  return result;
}

static olx_result add_node(obj_import *import, const struct aiNode *node, const olx_affine *parent) {
  const struct aiMatrix4x4 *m = &node->mTransformation;
  const olx_affine local = {{{(double)m->a1, (double)m->a2, (double)m->a3, (double)m->a4},
                             {(double)m->b1, (double)m->b2, (double)m->b3, (double)m->b4},
                             {(double)m->c1, (double)m->c2, (double)m->c3, (double)m->c4}}};
  const olx_affine transform = olx_affine_multiply(parent, &local);
  for (uint32_t i = 0; i < node->mNumMeshes; ++i) {
    OLX_TRY(add_mesh(import, import->source->mMeshes[node->mMeshes[i]], &transform));
  }
  // The nodes of an OBJ file are not nested.
  for (uint32_t i = 0; i < node->mNumChildren; ++i) OLX_TRY(add_node(import, node->mChildren[i], &transform));
  return OLX_OK;
}

static olx_result import_source(obj_import *import, const olx_affine *placement) {
  const struct aiScene *source = import->source;
  import->material_index = olx_allocate_zero(source->mNumMaterials, sizeof *import->material_index);
  import->absent = olx_allocate_zero(source->mNumMaterials, sizeof *import->absent);
  if (!import->material_index || !import->absent) return olx_fail(OLX_ERROR_MEMORY, "%s: out of memory", import->path);
  OLX_TRY(import_materials(import));
  if (source->mRootNode) OLX_TRY(add_node(import, source->mRootNode, placement));
  olx_warn_about_model(import->path, &import->notes, import->scene);
  if (import->colored_meshes) {
    olx_scene_warn(import->scene, "%s: the vertex colours of %u meshes are ignored", import->path,
                   import->colored_meshes);
  }
  return OLX_OK;
}

olx_result olx_import_obj(const char *path, const olx_affine *placement, olx_scene *scene) {
  obj_import import = {.path = path, .scene = scene};
  OLX_TRY(olx_obj_check(path, scene));
  OLX_TRY(olx_model_read(path, aiProcess_Triangulate, scene, &import.source));
  const olx_result result = import_source(&import, placement);
  olx_release(import.material_index);
  olx_release(import.absent);
  aiReleaseImport(import.source);
  return result;
}
