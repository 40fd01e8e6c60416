// Imports a glTF model into a scene: everything is checked and counted before memory is allocated for it.
#include "core/hooks.h"
#include "core/result.h"
#include "scene/gltf/gltf_accessor.h"
#include "scene/gltf/gltf_buffer.h"
#include "scene/gltf/gltf_draco.h"
#include "scene/gltf/gltf_instances.h"
#include "scene/gltf/gltf_light.h"
#include "scene/gltf/gltf_mesh.h"
#include "scene/gltf/gltf_node.h"
#include "scene/gltf/gltf_skin.h"
#include "scene/import/import_limits.h"

#include <stdio.h>

typedef struct gltf_import {
  olx_gltf *gltf;
  olx_gltf_roots roots;
  olx_gltf_surface *surfaces;  // one per material, and one for primitives without a material
  bool *seen;                  // one per mesh of the file's scene
  olx_gltf_node_place *places; // one per node
  olx_gltf_skin *skins;        // one per skin, read when a mesh needs it
  olx_gltf_mesh_notes notes;
  uint32_t skinned;
} gltf_import;

// Returns the mesh of a node; OLX_GLTF_NONE without one.
static uint32_t mesh_of(const olx_gltf *gltf, uint32_t node) {
  uint32_t mesh;
  olx_gltf_index(gltf->nodes.elements[node], "mesh", gltf->meshes.count, &mesh);
  return mesh;
}

// ---- Limits

static olx_result check_triangles(const olx_gltf *gltf, const char *list, uint32_t element, uint64_t triangles) {
  char name[32];
  snprintf(name, sizeof name, "%s[%u]", list, element);
  return olx_import_check_limit(gltf->scene, OLX_LIMIT_TRIANGLES, triangles, gltf->path, name);
}

// Counts the triangles of all instances: a mesh is imported once for every place in which a node puts it.
static olx_result check_instances(const olx_gltf *gltf, uint64_t *triangles) {
  uint64_t all = gltf->scene->triangle_count;
  for (uint32_t i = 0; i < gltf->meshes.count; ++i) {
    triangles[i] = olx_gltf_mesh_triangles(gltf, i);
    all += triangles[i];
    OLX_TRY(check_triangles(gltf, "meshes", i, all));
  }
  all = gltf->scene->triangle_count;
  for (uint32_t i = 0; i < gltf->nodes.count; ++i) {
    if (mesh_of(gltf, i) == OLX_GLTF_NONE) continue;
    all += triangles[mesh_of(gltf, i)] * olx_gltf_instance_count(gltf, i);
    OLX_TRY(check_triangles(gltf, "nodes", i, all));
  }
  return OLX_OK;
}

static uint64_t count_primitives(const olx_gltf *gltf) {
  uint64_t count = 0;
  for (uint32_t i = 0; i < gltf->meshes.count; ++i) {
    count += (uint64_t)cJSON_GetArraySize(olx_json_member(gltf->meshes.elements[i], "primitives"));
  }
  return count;
}

// Counts the nodes, and the instances as nodes of their own.
static uint64_t count_nodes(const olx_gltf *gltf) {
  uint64_t count = 0;
  for (uint32_t i = 0; i < gltf->nodes.count; ++i) count += olx_gltf_instance_count(gltf, i);
  return count;
}

static olx_result check_amounts(const olx_gltf *gltf) {
  const uint64_t materials = (uint64_t)gltf->scene->material_count + gltf->materials.count;
  const uint64_t nodes = count_nodes(gltf);
  OLX_TRY(olx_import_check_limit(gltf->scene, OLX_LIMIT_MATERIALS, materials, gltf->path, "materials"));
  OLX_TRY(olx_import_check_limit(gltf->scene, OLX_LIMIT_NODES, nodes, gltf->path, "nodes"));
  OLX_TRY(olx_import_check_limit(gltf->scene, OLX_LIMIT_NODES, nodes + count_primitives(gltf), gltf->path,
                                 "nodes and primitives"));
  uint64_t *triangles = olx_allocate(gltf->meshes.count, sizeof *triangles);
  if (!triangles) return olx_fail(OLX_ERROR_MEMORY, "%s: out of memory", gltf->path);
  const olx_result result = check_instances(gltf, triangles);
  olx_release(triangles);
  return result;
}

// ---- The file's scene

// Records where a node is, and marks the materials that its mesh uses.
static olx_result note_node(void *user, uint32_t node, const olx_affine *transform) {
  gltf_import *import = user;
  const olx_gltf *gltf = import->gltf;
  const uint32_t mesh = mesh_of(gltf, node);
  const cJSON *primitive = NULL;
  import->places[node] = (olx_gltf_node_place){true, *transform};
  if (mesh == OLX_GLTF_NONE || import->seen[mesh]) return OLX_OK;
  import->seen[mesh] = true;
  cJSON_ArrayForEach(primitive, olx_json_member(gltf->meshes.elements[mesh], "primitives")) {
    uint32_t material;
    olx_gltf_index(primitive, "material", gltf->materials.count, &material);
    import->surfaces[material == OLX_GLTF_NONE ? gltf->materials.count : material].used = true;
  }
  return OLX_OK;
}

// Adds the mesh of a node in all of its places.
static olx_result add_instances(gltf_import *import, uint32_t node, uint32_t mesh, const olx_affine *transform) {
  const olx_gltf *gltf = import->gltf;
  const uint32_t count = olx_gltf_instance_count(gltf, node);
  olx_affine *places = olx_allocate(count, sizeof *places);
  olx_result result = places ? olx_gltf_read_instances(gltf, node, places)
                             : olx_fail(OLX_ERROR_MEMORY, "%s: out of memory for %u instances", gltf->path, count);
  for (uint32_t i = 0; result == OLX_OK && i < count; ++i) {
    const olx_affine place = olx_affine_multiply(transform, &places[i]);
    result = olx_gltf_add_mesh(gltf, mesh, import->surfaces, &(olx_gltf_pose){&place, NULL}, &import->notes);
  }
  olx_release(places);
  return result;
}

// Adds a mesh that joints place, whatever the transform of its node and however many places the node has.
static olx_result add_skinned(gltf_import *import, uint32_t mesh, uint32_t index) {
  olx_gltf_skin *skin = &import->skins[index];
  if (!skin->joints) OLX_TRY(olx_gltf_read_skin(import->gltf, index, import->places, skin));
  ++import->skinned;
  return olx_gltf_add_mesh(import->gltf, mesh, import->surfaces, &(olx_gltf_pose){skin->joints, skin}, &import->notes);
}

static olx_result add_node(void *user, uint32_t node, const olx_affine *transform) {
  gltf_import *import = user;
  const uint32_t mesh = mesh_of(import->gltf, node);
  uint32_t skin;
  olx_gltf_index(import->gltf->nodes.elements[node], "skin", import->gltf->skins.count, &skin);
  if (mesh != OLX_GLTF_NONE) {
    OLX_TRY(skin == OLX_GLTF_NONE ? add_instances(import, node, mesh, transform) : add_skinned(import, mesh, skin));
  }
  OLX_TRY(olx_gltf_add_camera(import->gltf, node, transform));
  olx_gltf_add_light(import->gltf, node, transform);
  return OLX_OK;
}

static void warn_about_import(const gltf_import *import) {
  const olx_gltf *gltf = import->gltf;
  olx_warn_about_model(gltf->path, &import->notes.model, gltf->scene);
  if (import->skinned) {
    olx_scene_warn(gltf->scene, "%s: %u skinned meshes stand as their joints do at rest", gltf->path, import->skinned);
  }
  if (import->notes.unweighted) {
    olx_scene_warn(gltf->scene,
                   "%s: %u vertices of skinned meshes have no usable weights, and follow their first joint", gltf->path,
                   import->notes.unweighted);
  }
  if (import->notes.morphed) {
    olx_scene_warn(gltf->scene, "%s: the morph targets of %u meshes are ignored", gltf->path, import->notes.morphed);
  }
  if (import->notes.lost_attributes) {
    olx_scene_warn(gltf->scene, "%s: %u attributes are ignored: they have more or fewer elements than their positions",
                   gltf->path, import->notes.lost_attributes);
  }
}

static olx_result add_scene(gltf_import *import, const olx_affine *placement) {
  olx_gltf *gltf = import->gltf;
  import->surfaces = olx_allocate_zero((size_t)gltf->materials.count + 1, sizeof *import->surfaces);
  import->seen = olx_allocate_zero(gltf->meshes.count, sizeof *import->seen);
  import->places = olx_allocate_zero(gltf->nodes.count, sizeof *import->places);
  import->skins = olx_allocate_zero(gltf->skins.count, sizeof *import->skins);
  if (!import->surfaces || !import->seen || !import->places || !import->skins) {
    return olx_fail(OLX_ERROR_MEMORY, "%s: out of memory", gltf->path);
  }
  OLX_TRY(olx_gltf_walk(gltf, &import->roots, placement, note_node, import));
  OLX_TRY(olx_gltf_import_materials(gltf, import->surfaces));
  OLX_TRY(olx_gltf_walk(gltf, &import->roots, placement, add_node, import));
  warn_about_import(import);
  return OLX_OK;
}

static olx_result read_file(gltf_import *import, const char *path, const olx_affine *placement, olx_scene *scene) {
  olx_gltf *gltf = import->gltf;
  OLX_TRY(olx_gltf_open(path, scene, gltf));
  OLX_TRY(olx_gltf_open_buffers(gltf));
  OLX_TRY(olx_gltf_check_images(gltf));
  OLX_TRY(olx_gltf_check_samplers(gltf));
  OLX_TRY(olx_gltf_make_accessors(gltf));
  olx_gltf_mark_draco(gltf);
  OLX_TRY(olx_gltf_open_accessors(gltf));
  OLX_TRY(olx_gltf_check_meshes(gltf));
  OLX_TRY(olx_gltf_check_skins(gltf));
  OLX_TRY(olx_gltf_check_instances(gltf));
  OLX_TRY(olx_gltf_find_roots(gltf, &import->roots));
  OLX_TRY(check_amounts(gltf));
  return add_scene(import, placement);
}

olx_result olx_import_gltf(const char *path, const olx_affine *placement, olx_scene *scene) {
  olx_gltf gltf = {0};
  gltf_import import = {.gltf = &gltf};
  const olx_result result = read_file(&import, path, placement, scene);
  olx_release(import.roots.nodes);
  olx_release(import.surfaces);
  olx_release(import.seen);
  olx_release(import.places);
  for (uint32_t i = 0; import.skins && i < gltf.skins.count; ++i) olx_release(import.skins[i].joints);
  olx_release(import.skins);
  olx_gltf_release_images(&gltf);
  olx_gltf_release_accessors(&gltf);
  olx_gltf_release_buffers(&gltf);
  olx_gltf_close(&gltf);
  return result;
}
