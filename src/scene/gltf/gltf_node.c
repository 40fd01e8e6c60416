// Traverses the nodes of a glTF file. Before any recursion, it checks from the children up that they form trees of
// bounded depth.
#include "scene/gltf/gltf_node.h"

#include "core/hooks.h"
#include "core/result.h"
#include "scene/local_frame.h"

#include <string.h>

// Bound on the depth of trees, and so of recursion.
#define MAX_NODE_DEPTH 256u
// Value in place of a parent, for roots named by the file's scene.
#define NAMED_ROOT (OLX_GLTF_NONE - 1)

// ---- The forest

static olx_result note_children(const olx_gltf *gltf, uint32_t node, uint32_t *parents) {
  const cJSON *child = NULL;
  cJSON_ArrayForEach(child, olx_json_member(gltf->nodes.elements[node], "children")) {
    uint32_t index = 0;
    bool valid;
    if (!olx_json_index(child, gltf->nodes.count, &index, &valid)) {
      return olx_gltf_fail(gltf, "nodes", node, "a child does not exist");
    }
    if (parents[index] != OLX_GLTF_NONE) {
      return olx_gltf_fail(gltf, "nodes", index, "it is a child twice, so the nodes form no tree");
    }
    parents[index] = node;
  }
  return OLX_OK;
}

// Every node has at most one parent, so that following parents either reaches a root or never ends.
static olx_result check_depth(const olx_gltf *gltf, uint32_t node, const uint32_t *parents) {
  uint32_t depth = 0;
  for (uint32_t at = node; parents[at] < NAMED_ROOT && depth <= MAX_NODE_DEPTH; at = parents[at]) ++depth;
  if (depth <= MAX_NODE_DEPTH) return OLX_OK;
  return olx_gltf_fail(gltf, "nodes", node, "nodes contain each other, or are nested too deep");
}

static olx_result check_depths(const olx_gltf *gltf, const uint32_t *parents) {
  for (uint32_t i = 0; i < gltf->nodes.count; ++i) OLX_TRY(check_depth(gltf, i, parents));
  return OLX_OK;
}

static olx_result check_node(const olx_gltf *gltf, uint32_t node) {
  const cJSON *element = gltf->nodes.elements[node];
  uint32_t index;
  if (!olx_gltf_index(element, "mesh", gltf->meshes.count, &index)) {
    return olx_gltf_fail(gltf, "nodes", node, "its mesh does not exist");
  }
  if (!olx_gltf_index(element, "skin", gltf->skins.count, &index)) {
    return olx_gltf_fail(gltf, "nodes", node, "its skin does not exist");
  }
  if (!olx_gltf_index(element, "camera", gltf->cameras.count, &index)) {
    return olx_gltf_fail(gltf, "nodes", node, "its camera does not exist");
  }
  if (!olx_gltf_index(olx_gltf_extension(element, "KHR_lights_punctual"), "light", gltf->lights.count, &index)) {
    return olx_gltf_fail(gltf, "nodes", node, "its light does not exist");
  }
  return OLX_OK;
}

static olx_result find_parents(const olx_gltf *gltf, uint32_t *parents) {
  for (uint32_t i = 0; i < gltf->nodes.count; ++i) parents[i] = OLX_GLTF_NONE;
  for (uint32_t i = 0; i < gltf->nodes.count; ++i) {
    OLX_TRY(check_node(gltf, i));
    OLX_TRY(note_children(gltf, i, parents));
  }
  return OLX_OK;
}

// Reads the roots that scene `index` names into `kept` unless that is NULL.
static olx_result read_scene(const olx_gltf *gltf, uint32_t index, uint32_t *parents, olx_gltf_roots *kept) {
  const cJSON *root = NULL;
  cJSON_ArrayForEach(root, olx_json_member(gltf->scenes.elements[index], "nodes")) {
    uint32_t node = 0;
    bool valid;
    if (!olx_json_index(root, gltf->nodes.count, &node, &valid)) {
      return olx_gltf_fail(gltf, "scenes", index, "a node does not exist");
    }
    if (parents[node] < NAMED_ROOT) {
      return olx_gltf_fail(gltf, "scenes", index, "it names a node that is another node's child");
    }
    if (!kept) continue;
    if (parents[node] == NAMED_ROOT) return olx_gltf_fail(gltf, "scenes", index, "it names a node twice");
    parents[node] = NAMED_ROOT;
    kept->nodes[kept->count++] = node;
  }
  return OLX_OK;
}

static olx_result read_scenes(const olx_gltf *gltf, uint32_t *parents, olx_gltf_roots *roots) {
  uint32_t chosen;
  if (!olx_gltf_index(gltf->root, "scene", gltf->scenes.count, &chosen)) {
    return olx_fail(OLX_ERROR_FORMAT, "%s: scene: that scene does not exist", gltf->path);
  }
  if (chosen == OLX_GLTF_NONE) chosen = 0;
  for (uint32_t i = 0; i < gltf->scenes.count; ++i) {
    OLX_TRY(read_scene(gltf, i, parents, i == chosen ? roots : NULL));
  }
  for (uint32_t i = 0; gltf->scenes.count == 0 && i < gltf->nodes.count; ++i) {
    if (parents[i] == OLX_GLTF_NONE) roots->nodes[roots->count++] = i;
  }
  return OLX_OK;
}

static olx_result find_roots(const olx_gltf *gltf, uint32_t *parents, olx_gltf_roots *roots) {
  OLX_TRY(find_parents(gltf, parents));
  OLX_TRY(read_scenes(gltf, parents, roots));
  return check_depths(gltf, parents);
}

olx_result olx_gltf_find_roots(const olx_gltf *gltf, olx_gltf_roots *roots) {
  uint32_t *parents = olx_allocate(gltf->nodes.count, sizeof *parents);
  *roots = (olx_gltf_roots){.nodes = olx_allocate(gltf->nodes.count, sizeof *roots->nodes)};
  const olx_result result = parents && roots->nodes ? find_roots(gltf, parents, roots)
                                                    : olx_fail(OLX_ERROR_MEMORY, "%s: out of memory", gltf->path);
  olx_release(parents);
  return result;
}

// ---- Transforms

static olx_affine from_matrix(const double m[16]) {
  olx_affine a;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) a.m[row][column] = (double)(float)m[column * 4 + row];
  }
  return a;
}

static olx_affine from_parts(const cJSON *node) {
  float q[4] = {0.0f, 0.0f, 0.0f, 1.0f}, s[3] = {1.0f, 1.0f, 1.0f};
  olx_json_floats(olx_json_member(node, "rotation"), q, 4);
  olx_json_floats(olx_json_member(node, "scale"), s, 3);
  return olx_affine_from_trs((const double[3]){0.0, 0.0, 0.0},
                             (const double[4]){(double)q[0], (double)q[1], (double)q[2], (double)q[3]},
                             (const double[3]){(double)s[0], (double)s[1], (double)s[2]});
}

olx_affine olx_gltf_node_transform(const olx_gltf *gltf, uint32_t node) {
  const cJSON *element = gltf->nodes.elements[node];
  double m[16], translation[3] = {0.0, 0.0, 0.0};
  const bool matrix = olx_json_doubles(olx_json_member(element, "matrix"), m, 16);
  if (matrix) memcpy(translation, m + 12, sizeof translation);
  else olx_json_doubles(olx_json_member(element, "translation"), translation, 3);
  olx_affine transform = matrix ? from_matrix(m) : from_parts(element);
  for (int row = 0; row < 3; ++row) transform.m[row][3] = olx_scene_length(gltf->scene, translation[row]);
  return transform;
}

// ---- Traversal

typedef struct walker {
  const olx_gltf *gltf;
  olx_result (*visit)(void *user, uint32_t node, const olx_affine *transform);
  void *user;
} walker;

// The recursion is bounded by olx_gltf_find_roots.
static olx_result walk_node(const walker *w, uint32_t node, const olx_affine *parent) {
  const olx_affine local = olx_gltf_node_transform(w->gltf, node), transform = olx_affine_multiply(parent, &local);
  const cJSON *child = NULL;
  OLX_TRY(w->visit(w->user, node, &transform));
  cJSON_ArrayForEach(child, olx_json_member(w->gltf->nodes.elements[node], "children")) {
    OLX_TRY(walk_node(w, (uint32_t)child->valuedouble, &transform));
  }
  return OLX_OK;
}

olx_result olx_gltf_walk(const olx_gltf *gltf, const olx_gltf_roots *roots, const olx_affine *placement,
                         olx_result (*visit)(void *user, uint32_t node, const olx_affine *transform), void *user) {
  const walker w = {.gltf = gltf, .visit = visit, .user = user};
  for (uint32_t i = 0; i < roots->count; ++i) OLX_TRY(walk_node(&w, roots->nodes[i], placement));
  return OLX_OK;
}
