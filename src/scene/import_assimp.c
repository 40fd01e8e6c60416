#include "core/hooks.h"
#include "core/result.h"
#include "scene/import_material.h"
#include "scene/model_files.h"
#include "scene/obj_check.h"
#include "scene/scene_build.h"

#include <assimp/cimport.h>
#include <assimp/postprocess.h>

#include <stdio.h>
#include <string.h>
#include <strings.h>

typedef struct model_import {
  const char *path;
  olx_scene *scene;
  olx_material_import materials;
  uint32_t *material_index; // in the scene, a material of the source; UINT32_MAX when no mesh uses it
  uint32_t *uv_set;         // a material of the source
  bool *absent;             // a material of the source
  uint64_t absent_triangles, thin_faces;
  uint32_t skinned_meshes, colored_meshes;
  float farthest; // largest coordinate of a vertex, before it is placed
} model_import;

static bool has_extension(const char *path, const char *extension) {
  const size_t length = strlen(path), tail = strlen(extension);
  return length >= tail && strcasecmp(path + length - tail, extension) == 0;
}

// Leaves 0 in material_index for the materials that a mesh uses, UINT32_MAX for the others.
static void mark_used_materials(model_import *import) {
  const struct aiScene *source = import->materials.source;
  for (uint32_t i = 0; i < source->mNumMaterials; ++i) import->material_index[i] = UINT32_MAX;
  for (uint32_t i = 0; i < source->mNumMeshes; ++i) {
    const uint32_t material = source->mMeshes[i]->mMaterialIndex;
    if (material < source->mNumMaterials) import->material_index[material] = 0;
  }
}

static void resolve_textures(const olx_texture_table *textures, olx_material *m) {
  m->base_color_texture = olx_texture_table_resolve(textures, m->base_color_texture);
  m->alpha_texture = olx_texture_table_resolve(textures, m->alpha_texture);
  m->metallic_roughness_texture = olx_texture_table_resolve(textures, m->metallic_roughness_texture);
  m->emission_texture = olx_texture_table_resolve(textures, m->emission_texture);
  m->normal_texture = olx_texture_table_resolve(textures, m->normal_texture);
}

static void warn_about_materials(model_import *import) {
  const struct {
    const olx_name_list *list;
    const char *what;
  } kinds[] = {
      {&import->materials.clamped, "an albedo above 0.95, clamped"},
      {&import->materials.repaired, "numbers outside their range, clamped"},
      {&import->materials.translucent, "partial opacity: absent below 0.5, else opaque"},
      {&import->materials.mixed_uvs, "textures with different uv sets: the first one's set is used"},
  };
  for (size_t i = 0; i < sizeof kinds / sizeof *kinds; ++i) {
    if (!kinds[i].list->count) continue;
    olx_scene_warn(import->scene, "%s: %u material%s %s (%s)", import->path, kinds[i].list->count,
                   kinds[i].list->count == 1 ? " has" : "s have", kinds[i].what, kinds[i].list->names);
  }
}

static olx_result import_materials(model_import *import) {
  const struct aiScene *source = import->materials.source;
  const uint32_t first = import->scene->material_count;
  mark_used_materials(import);
  for (uint32_t i = 0; i < source->mNumMaterials; ++i) {
    if (import->material_index[i] == UINT32_MAX) continue;
    olx_material material;
    OLX_TRY(olx_import_material(&import->materials, i, &material, &import->uv_set[i]));
    import->absent[i] = olx_material_absent(&material);
    OLX_TRY(olx_scene_add_material(import->scene, &material, &import->material_index[i]));
  }
  OLX_TRY(olx_texture_table_load(&import->materials.textures, import->path, import->scene));
  for (uint32_t i = first; i < import->scene->material_count; ++i) {
    resolve_textures(&import->materials.textures, &import->scene->materials[i]);
  }
  warn_about_materials(import);
  return OLX_OK;
}

// One mesh's arrays in the form olx_scene_add_mesh takes.
typedef struct mesh_arrays {
  olx_vec3 *positions, *normals;
  olx_vec2 *uvs;
  uint32_t *indices;
  uint32_t triangle_count;
} mesh_arrays;

static void fill_vertices(model_import *import, const struct aiMesh *mesh, const struct aiVector3D *uvs,
                          const olx_affine *transform, mesh_arrays *out) {
  const olx_affine normals = olx_affine_normals(transform);
  const double mirrored = olx_affine_determinant(transform) < 0.0 ? -1.0 : 1.0;
  for (uint32_t i = 0; i < mesh->mNumVertices; ++i) {
    const struct aiVector3D p = mesh->mVertices[i];
    import->farthest = olx_max(import->farthest, olx_max3(olx_v3(fabsf(p.x), fabsf(p.y), fabsf(p.z))));
    out->positions[i] = olx_affine_point(transform, olx_v3(p.x, p.y, p.z));
    if (out->normals) {
      const struct aiVector3D n = mesh->mNormals[i];
      const olx_vec3 turned = olx_affine_vector(&normals, olx_normalize(olx_v3(n.x, n.y, n.z)));
      out->normals[i] = olx_scale(turned, (float)mirrored);
    }
    // Assimp counts v upwards from the bottom of the image, the scene downwards from its top.
    if (out->uvs) out->uvs[i] = (olx_vec2){uvs[i].x, 1.0f - uvs[i].y};
  }
}

// Triangles only; a mirroring transform turns them round so that fronts stay fronts.
static void fill_indices(model_import *import, const struct aiMesh *mesh, bool mirrored, mesh_arrays *out) {
  uint32_t *index = out->indices;
  for (uint32_t i = 0; i < mesh->mNumFaces; ++i) {
    const struct aiFace *face = &mesh->mFaces[i];
    if (face->mNumIndices != 3) {
      ++import->thin_faces;
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

static olx_result add_mesh_arrays(model_import *import, const struct aiMesh *mesh, const olx_affine *transform,
                                  mesh_arrays *out) {
  const uint32_t set = import->uv_set[mesh->mMaterialIndex];
  const struct aiVector3D *uvs = set < AI_MAX_NUMBER_OF_TEXTURECOORDS ? mesh->mTextureCoords[set] : NULL;
  out->positions = olx_allocate(mesh->mNumVertices, sizeof *out->positions);
  out->normals = mesh->mNormals ? olx_allocate(mesh->mNumVertices, sizeof *out->normals) : NULL;
  out->uvs = uvs ? olx_allocate(mesh->mNumVertices, sizeof *out->uvs) : NULL;
  out->indices = olx_allocate(mesh->mNumFaces, 3 * sizeof *out->indices);
  if (!out->positions || !out->indices || (mesh->mNormals && !out->normals) || (uvs && !out->uvs)) {
    return olx_fail(OLX_ERROR_MEMORY, "%s: out of memory for mesh \"%.100s\"", import->path, mesh->mName.data);
  }
  fill_vertices(import, mesh, uvs, transform, out);
  fill_indices(import, mesh, olx_affine_determinant(transform) < 0.0, out);
  char name[2048];
  snprintf(name, sizeof name, "%.1024s: mesh \"%.100s\"", import->path, mesh->mName.data);
  return olx_scene_add_mesh(import->scene, name, out->positions, out->normals, out->uvs, mesh->mNumVertices,
                            out->indices, out->triangle_count, import->material_index[mesh->mMaterialIndex]);
}

static olx_result add_mesh(model_import *import, const struct aiMesh *mesh, const olx_affine *transform) {
  if (!mesh->mVertices || mesh->mMaterialIndex >= import->materials.source->mNumMaterials) return OLX_OK;
  if (import->absent[mesh->mMaterialIndex]) {
    import->absent_triangles += mesh->mNumFaces;
    return OLX_OK;
  }
  import->skinned_meshes += mesh->mNumBones > 0;
  import->colored_meshes += mesh->mColors[0] != NULL;
  mesh_arrays arrays = {0};
  const olx_result result = add_mesh_arrays(import, mesh, transform, &arrays);
  free_arrays(&arrays);
  return result;
}

// Far from the origin a node's translation counts in double precision; Assimp has it in floats. `json` is the node in the file, or
// NULL.
static void refine_translation(const model_import *import, const cJSON *json, olx_affine *local) {
  if (!json || !olx_scene_is_far(import->scene)) return;
  double translation[3];
  olx_gltf_translation(json, translation);
  for (int row = 0; row < 3; ++row) {
    if ((double)(float)translation[row] == local->m[row][3]) local->m[row][3] = translation[row];
  }
}

// `json` is the node of the file that Assimp's is made of, `children` the numbers of its children; NULL where there is none.
static olx_result add_node(model_import *import, const struct aiNode *node, const cJSON *json, const cJSON *children,
                           const olx_affine *parent) {
  const struct aiMatrix4x4 *m = &node->mTransformation;
  olx_affine local = {{{(double)m->a1, (double)m->a2, (double)m->a3, (double)m->a4},
                       {(double)m->b1, (double)m->b2, (double)m->b3, (double)m->b4},
                       {(double)m->c1, (double)m->c2, (double)m->c3, (double)m->c4}}};
  refine_translation(import, json, &local);
  const olx_affine transform = olx_affine_multiply(parent, &local);
  for (uint32_t i = 0; i < node->mNumMeshes; ++i) {
    OLX_TRY(add_mesh(import, import->materials.source->mMeshes[node->mMeshes[i]], &transform));
  }
  // OBJ nodes are flat, and olx_gltf_check has bounded the depth of the others.
  const cJSON *number = children ? children->child : NULL;
  for (uint32_t i = 0; i < node->mNumChildren; ++i) {
    const cJSON *child = number ? olx_gltf_node(import->materials.gltf, number) : NULL;
    OLX_TRY(add_node(import, node->mChildren[i], child, child ? olx_gltf_children(child) : NULL, &transform));
    if (number) number = number->next;
  }
  return OLX_OK;
}

// Assimp makes a root of its own above several roots of a file.
static olx_result add_root(model_import *import, const olx_affine *placement) {
  const struct aiNode *root = import->materials.source->mRootNode;
  const olx_gltf *gltf = import->materials.gltf;
  if (!root) return OLX_OK;
  const cJSON *roots = gltf ? olx_gltf_roots(gltf) : NULL;
  if (cJSON_GetArraySize(roots) != 1) return add_node(import, root, NULL, roots, placement);
  const cJSON *node = olx_gltf_node(gltf, roots->child);
  return add_node(import, root, node, node ? olx_gltf_children(node) : NULL, placement);
}

// Vertices are floats in the file, or are read as such: far from the model's own zero they are coarse.
static void warn_about_coarse_vertices(model_import *import, float scale) {
  const olx_box *box = &import->scene->made_of;
  const float diagonal = olx_length(olx_sub(box->max, box->min));
  const float apart = scale * (nextafterf(import->farthest, INFINITY) - import->farthest);
  if (!(apart > 0x1p-18f * diagonal)) return;
  olx_scene_warn(
      import->scene,
      "%s: vertices are up to %g from the model's own zero, where floats are %g m apart: keep vertices near it, and "
      "move the model by a node or by \"translate\"",
      import->path, (double)import->farthest, (double)apart);
}

static void warn_about_meshes(model_import *import) {
  olx_scene *scene = import->scene;
  if (import->absent_triangles) {
    olx_scene_warn(scene, "%s: skipped %llu triangles of materials whose opacity is below their cutoff", import->path,
                   (unsigned long long)import->absent_triangles);
  }
  if (import->thin_faces) {
    olx_scene_warn(scene, "%s: skipped %llu points and lines", import->path, (unsigned long long)import->thin_faces);
  }
  if (import->skinned_meshes) {
    olx_scene_warn(scene, "%s: %u skinned meshes stand in their bind pose", import->path, import->skinned_meshes);
  }
  if (import->colored_meshes) {
    olx_scene_warn(scene, "%s: the vertex colours of %u meshes are ignored", import->path, import->colored_meshes);
  }
}

static olx_result import_source(model_import *import, const olx_affine *placement) {
  const struct aiScene *source = import->materials.source;
  import->material_index = olx_allocate_zero(source->mNumMaterials, sizeof *import->material_index);
  import->uv_set = olx_allocate_zero(source->mNumMaterials, sizeof *import->uv_set);
  import->absent = olx_allocate_zero(source->mNumMaterials, sizeof *import->absent);
  if (!import->material_index || !import->uv_set || !import->absent) {
    return olx_fail(OLX_ERROR_MEMORY, "%s: out of memory", import->path);
  }
  OLX_TRY(import_materials(import));
  OLX_TRY(add_root(import, placement));
  warn_about_meshes(import);
  if (!import->materials.gltf) return OLX_OK;
  return olx_gltf_add_cameras_and_lights(import->materials.gltf, placement, import->scene);
}

static olx_result import_checked(const char *path, const olx_placement *placement, olx_scene *scene,
                                 const olx_gltf *gltf) {
  const struct aiScene *source;
  OLX_TRY(olx_model_read(path, gltf ? 0 : aiProcess_Triangulate, scene, &source));
  model_import import = {
      .path = path, .scene = scene, .materials = {.path = path, .scene = scene, .source = source, .gltf = gltf}};
  const olx_affine transform = olx_affine_from_placement(placement, scene->origin);
  const olx_result result = import_source(&import, &transform);
  if (result == OLX_OK) warn_about_coarse_vertices(&import, placement->scale);
  olx_texture_table_free(&import.materials.textures);
  olx_release(import.material_index);
  olx_release(import.uv_set);
  olx_release(import.absent);
  aiReleaseImport(source);
  return result;
}

olx_result olx_import_model(const char *path, const olx_placement *placement, olx_scene *scene) {
  if (has_extension(path, ".obj")) {
    OLX_TRY(olx_obj_check(path, scene));
    return import_checked(path, placement, scene, NULL);
  }
  if (!has_extension(path, ".gltf") && !has_extension(path, ".glb")) {
    return olx_fail(OLX_ERROR_UNSUPPORTED, "%s: not a model: expected .gltf, .glb or .obj", path);
  }
  olx_gltf *gltf;
  OLX_TRY(olx_gltf_open(path, scene, &gltf));
  const olx_result result = import_checked(path, placement, scene, gltf);
  olx_gltf_close(gltf);
  return result;
}
