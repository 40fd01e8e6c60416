#include "scene/gltf_check.h"

#include "core/hooks.h"
#include "core/result.h"
#include "scene/import_limits.h"
#include "scene/scene_build.h"

#include <stdio.h>
#include <string.h>

// Deeper trees would be walked by recursion, here and in Assimp.
#define MAX_NODE_DEPTH 256u

typedef struct checker {
  const char *path;
  const cJSON *root;
  uint32_t accessor_count, view_count, buffer_count, material_count, mesh_count, node_count, image_count, texture_count;
  const cJSON **accessors, **views, **buffers;
} checker;

static const cJSON *member(const cJSON *object, const char *key) {
  return cJSON_GetObjectItemCaseSensitive(object, key);
}

static olx_result fail(const checker *c, const char *list, uint32_t element, const char *what) {
  return olx_fail(OLX_ERROR_FORMAT, "%s: %s[%u]: %s", c->path, list, element, what);
}

// A member that counts bytes or elements; `otherwise` when it is absent. False when it is not a whole number.
static bool read_size(const cJSON *object, const char *key, uint64_t otherwise, uint64_t *size) {
  const cJSON *item = member(object, key);
  *size = otherwise;
  if (!item) return true;
  const double number = cJSON_IsNumber(item) ? item->valuedouble : -1.0;
  if (!(number >= 0.0 && number <= 0x1p48) || number != floor(number)) return false;
  *size = (uint64_t)number;
  return true;
}

// An optional member that must be an index below `count` when it is there.
static bool index_fits(const cJSON *object, const char *key, uint32_t count) {
  uint32_t index;
  bool valid;
  olx_json_index(member(object, key), count, &index, &valid);
  return valid;
}

static const char *const supported_extensions[] = {"KHR_lights_punctual", "KHR_materials_emissive_strength",
                                                   "KHR_materials_specular"};
// They change the look of a material, so a scene can do without them.
static const char *const ignored_extensions[] = {
    "KHR_materials_clearcoat",    "KHR_materials_ior",   "KHR_materials_iridescence", "KHR_materials_sheen",
    "KHR_materials_transmission", "KHR_materials_unlit", "KHR_materials_variants",    "KHR_materials_volume",
    "KHR_texture_transform",      "KHR_xmp_json_ld"};

static bool listed(const char *name, const char *const *list, size_t count) {
  for (size_t i = 0; i < count; ++i) {
    if (strcmp(name, list[i]) == 0) return true;
  }
  return false;
}

#define LISTED(name, list) listed((name), (list), sizeof(list) / sizeof *(list))

static olx_result check_extensions(const checker *c, olx_scene *scene) {
  const cJSON *name = NULL;
  cJSON_ArrayForEach(name, member(c->root, "extensionsRequired")) {
    if (!cJSON_IsString(name))
      return olx_fail(OLX_ERROR_FORMAT, "%s: extensionsRequired: not a list of names", c->path);
    if (!LISTED(name->valuestring, supported_extensions) && !LISTED(name->valuestring, ignored_extensions)) {
      return olx_fail(OLX_ERROR_UNSUPPORTED, "%s: the file needs the glTF extension %.100s, which is not supported",
                      c->path, name->valuestring);
    }
  }
  uint32_t ignored = 0;
  cJSON_ArrayForEach(name, member(c->root, "extensionsUsed")) {
    if (cJSON_IsString(name) && !LISTED(name->valuestring, supported_extensions) && ++ignored <= 32) {
      olx_scene_warn(scene, "%s: the glTF extension %.100s is ignored", c->path, name->valuestring);
    }
  }
  return OLX_OK;
}

static olx_result collect(const checker *c, const char *key, const cJSON ***elements, uint32_t *count) {
  const cJSON *array = member(c->root, key), *element = NULL;
  *count = cJSON_IsArray(array) ? (uint32_t)cJSON_GetArraySize(array) : 0;
  if (array && !cJSON_IsArray(array)) return olx_fail(OLX_ERROR_FORMAT, "%s: %s: not an array", c->path, key);
  if (elements && !(*elements = olx_allocate(*count, sizeof **elements))) {
    return olx_fail(OLX_ERROR_MEMORY, "%s: out of memory", c->path);
  }
  uint32_t i = 0;
  cJSON_ArrayForEach(element, array) {
    if (!cJSON_IsObject(element)) return fail(c, key, i, "not an object");
    if (elements) (*elements)[i] = element;
    ++i;
  }
  return OLX_OK;
}

static olx_result check_views(const checker *c) {
  for (uint32_t i = 0; i < c->view_count; ++i) {
    uint32_t buffer = 0;
    bool valid;
    uint64_t offset, length, available;
    if (!olx_json_index(member(c->views[i], "buffer"), c->buffer_count, &buffer, &valid)) {
      return fail(c, "bufferViews", i, "its buffer does not exist");
    }
    if (!read_size(c->views[i], "byteOffset", 0, &offset) || !read_size(c->views[i], "byteLength", 0, &length) ||
        !read_size(c->buffers[buffer], "byteLength", 0, &available) || offset + length > available) {
      return fail(c, "bufferViews", i, "it reaches past the end of its buffer");
    }
  }
  return OLX_OK;
}

static uint64_t component_bytes(uint64_t component_type) {
  switch (component_type) {
  case 5120:
  case 5121: return 1;
  case 5122:
  case 5123: return 2;
  case 5125:
  case 5126: return 4;
  default: return 0;
  }
}

static uint64_t component_count(const cJSON *type) {
  static const char *const names[] = {"SCALAR", "VEC2", "VEC3", "VEC4", "MAT2", "MAT3", "MAT4"};
  static const uint64_t counts[] = {1, 2, 3, 4, 4, 9, 16};
  for (size_t i = 0; cJSON_IsString(type) && i < sizeof counts / sizeof *counts; ++i) {
    if (strcmp(type->valuestring, names[i]) == 0) return counts[i];
  }
  return 0;
}

static olx_result check_accessor(const checker *c, uint32_t i) {
  const cJSON *accessor = c->accessors[i];
  uint64_t type, count, offset, stride, length;
  uint32_t view = 0;
  bool valid;
  if (member(accessor, "sparse")) {
    return olx_fail(OLX_ERROR_UNSUPPORTED, "%s: accessors[%u]: sparse accessors are not supported", c->path, i);
  }
  const uint64_t components = component_count(member(accessor, "type"));
  if (!read_size(accessor, "componentType", 0, &type) || !component_bytes(type) || !components) {
    return fail(c, "accessors", i, "its type or componentType is not known");
  }
  if (!read_size(accessor, "count", 0, &count) || count == 0 || count > UINT32_MAX / 4) {
    return fail(c, "accessors", i, "its count is not a sensible number");
  }
  if (!olx_json_index(member(accessor, "bufferView"), c->view_count, &view, &valid)) {
    return fail(c, "accessors", i, "its bufferView does not exist");
  }
  const uint64_t element = components * component_bytes(type);
  if (!read_size(accessor, "byteOffset", 0, &offset) || !read_size(c->views[view], "byteStride", 0, &stride) ||
      !read_size(c->views[view], "byteLength", 0, &length) || (stride && stride < element) || stride > 1024 ||
      offset + (stride ? stride : element) * (count - 1) + element > length) {
    return fail(c, "accessors", i, "it reaches past the end of its bufferView");
  }
  return OLX_OK;
}

// Assimp copies attributes without looking at their type.
static olx_result check_attribute(const checker *c, uint32_t mesh, const cJSON *attribute) {
  uint32_t index = 0;
  bool valid;
  if (!olx_json_index(attribute, c->accessor_count, &index, &valid)) {
    return fail(c, "meshes", mesh, "an attribute's accessor does not exist");
  }
  const char *name = attribute->string;
  const bool position = strcmp(name, "POSITION") == 0, normal = strcmp(name, "NORMAL") == 0;
  const bool uv = strncmp(name, "TEXCOORD_", 9) == 0;
  if (!position && !normal && !uv) return OLX_OK;
  uint64_t type = 0;
  read_size(c->accessors[index], "componentType", 0, &type);
  const uint64_t components = component_count(member(c->accessors[index], "type"));
  if (type == 5126 && components == (uv ? 2u : 3u)) return OLX_OK;
  return olx_fail(OLX_ERROR_UNSUPPORTED, "%s: meshes[%u]: %.100s is not made of %d floats", c->path, mesh, name,
                  uv ? 2 : 3);
}

static olx_result check_indices(const checker *c, uint32_t mesh, const cJSON *primitive) {
  uint32_t index = 0;
  bool valid;
  if (!olx_json_index(member(primitive, "indices"), c->accessor_count, &index, &valid)) {
    return valid ? OLX_OK : fail(c, "meshes", mesh, "the accessor of its indices does not exist");
  }
  uint64_t type = 0;
  read_size(c->accessors[index], "componentType", 0, &type);
  if ((type != 5121 && type != 5123 && type != 5125) || component_count(member(c->accessors[index], "type")) != 1) {
    return fail(c, "meshes", mesh, "its indices are not unsigned numbers");
  }
  return OLX_OK;
}

// Assimp subtracts from the number of corners without a look.
static olx_result check_mode(const checker *c, uint32_t mesh, const cJSON *primitive) {
  static const uint64_t fewest[] = {1, 2, 2, 2, 3, 3, 3}; // points, lines, loops, strips; triangles, strips, fans
  const cJSON *corners = member(primitive, "indices");
  if (!corners) corners = member(member(primitive, "attributes"), "POSITION");
  uint64_t mode, count = 0;
  uint32_t index = 0;
  bool valid;
  if (!read_size(primitive, "mode", 4, &mode) || mode > 6) return fail(c, "meshes", mesh, "its mode is not known");
  if (!olx_json_index(corners, c->accessor_count, &index, &valid)) return OLX_OK;
  read_size(c->accessors[index], "count", 0, &count);
  return count >= fewest[mode] ? OLX_OK : fail(c, "meshes", mesh, "it has too few corners for its mode");
}

static olx_result check_meshes(const checker *c) {
  uint32_t i = 0;
  const cJSON *mesh = NULL, *primitive = NULL, *attribute = NULL;
  cJSON_ArrayForEach(mesh, member(c->root, "meshes")) {
    if (!cJSON_IsArray(member(mesh, "primitives"))) return fail(c, "meshes", i, "it has no primitives");
    cJSON_ArrayForEach(primitive, member(mesh, "primitives")) {
      if (!index_fits(primitive, "material", c->material_count)) {
        return fail(c, "meshes", i, "its material does not exist");
      }
      if (!cJSON_IsObject(member(primitive, "attributes"))) return fail(c, "meshes", i, "it has no attributes");
      cJSON_ArrayForEach(attribute, member(primitive, "attributes")) OLX_TRY(check_attribute(c, i, attribute));
      OLX_TRY(check_indices(c, i, primitive));
      OLX_TRY(check_mode(c, i, primitive));
    }
    ++i;
  }
  return OLX_OK;
}

static olx_result check_images(const checker *c) {
  uint32_t i = 0;
  const cJSON *element = NULL;
  cJSON_ArrayForEach(element, member(c->root, "images")) {
    if (!index_fits(element, "bufferView", c->view_count)) return fail(c, "images", i, "its bufferView does not exist");
    ++i;
  }
  i = 0;
  cJSON_ArrayForEach(element, member(c->root, "textures")) {
    if (!index_fits(element, "source", c->image_count)) return fail(c, "textures", i, "its image does not exist");
    ++i;
  }
  return OLX_OK;
}

static olx_result note_parents(const checker *c, uint32_t *parents) {
  uint32_t i = 0;
  const cJSON *node = NULL, *child = NULL;
  cJSON_ArrayForEach(node, member(c->root, "nodes")) {
    if (!index_fits(node, "mesh", c->mesh_count)) return fail(c, "nodes", i, "its mesh does not exist");
    cJSON_ArrayForEach(child, member(node, "children")) {
      uint32_t index = 0;
      bool valid;
      if (!olx_json_index(child, c->node_count, &index, &valid)) return fail(c, "nodes", i, "a child does not exist");
      if (parents[index] != UINT32_MAX)
        return fail(c, "nodes", index, "it is a child twice, so the nodes form no tree");
      parents[index] = i;
    }
    ++i;
  }
  return OLX_OK;
}

static olx_result check_roots(const checker *c, const uint32_t *parents) {
  uint32_t i = 0;
  const cJSON *scene = NULL, *root = NULL;
  cJSON_ArrayForEach(scene, member(c->root, "scenes")) {
    cJSON_ArrayForEach(root, member(scene, "nodes")) {
      uint32_t index = 0;
      bool valid;
      if (!olx_json_index(root, c->node_count, &index, &valid)) return fail(c, "scenes", i, "a node does not exist");
      if (parents[index] != UINT32_MAX) return fail(c, "scenes", i, "it names a node that is another node's child");
    }
    ++i;
  }
  return OLX_OK;
}

// Every node has one parent at most, so walking up ends at a root or never.
static olx_result check_depths(const checker *c, const uint32_t *parents) {
  for (uint32_t i = 0; i < c->node_count; ++i) {
    uint32_t depth = 0, node = i;
    while (parents[node] != UINT32_MAX && ++depth <= MAX_NODE_DEPTH) node = parents[node];
    if (depth > MAX_NODE_DEPTH) return fail(c, "nodes", i, "nodes contain each other, or are nested too deep");
  }
  return OLX_OK;
}

static olx_result check_nodes(const checker *c) {
  const cJSON *scenes = member(c->root, "scenes");
  if (!index_fits(c->root, "scene", (uint32_t)cJSON_GetArraySize(scenes))) {
    return olx_fail(OLX_ERROR_FORMAT, "%s: scene: that scene does not exist", c->path);
  }
  uint32_t *parents = olx_allocate(c->node_count, sizeof *parents);
  if (!parents) return olx_fail(OLX_ERROR_MEMORY, "%s: out of memory", c->path);
  for (uint32_t i = 0; i < c->node_count; ++i) parents[i] = UINT32_MAX;
  olx_result result = note_parents(c, parents);
  if (result == OLX_OK) result = check_roots(c, parents);
  if (result == OLX_OK) result = check_depths(c, parents);
  olx_release(parents);
  return result;
}

// An accessor's count of elements, 0 where it is not there.
static uint64_t element_count(const checker *c, const cJSON *accessor) {
  uint64_t count = 0;
  uint32_t index = 0;
  bool valid;
  if (olx_json_index(accessor, c->accessor_count, &index, &valid)) read_size(c->accessors[index], "count", 0, &count);
  return count;
}

static uint64_t attribute_count(const checker *c, const cJSON *attributes) {
  const cJSON *attribute = NULL;
  uint64_t most = 0;
  cJSON_ArrayForEach(attribute, attributes) {
    const uint64_t count = element_count(c, attribute);
    if (count > most) most = count;
  }
  return most;
}

// What a primitive costs to read, in triangles: those that it has, or as many as its vertices and morphs would make.
static uint64_t primitive_triangles(const checker *c, const cJSON *primitive) {
  const uint64_t vertices = attribute_count(c, member(primitive, "attributes"));
  const uint64_t indices = element_count(c, member(primitive, "indices"));
  uint64_t mode, corners = indices ? indices : vertices, morphed = vertices;
  const cJSON *target = NULL;
  read_size(primitive, "mode", 4, &mode);
  cJSON_ArrayForEach(target, member(primitive, "targets")) morphed += attribute_count(c, target);
  const uint64_t triangles = mode > 4 && corners > 2 ? corners - 2 : corners / 3;
  return triangles > morphed / 3 ? triangles : morphed / 3;
}

// Triangles of every mesh, into `triangles`, and how many primitives there are.
static olx_result count_triangles(const checker *c, const olx_scene *scene, uint64_t *triangles, uint64_t *primitives) {
  const cJSON *mesh = NULL, *primitive = NULL;
  uint64_t all = scene->triangle_count;
  uint32_t i = 0;
  cJSON_ArrayForEach(mesh, member(c->root, "meshes")) {
    char element[32];
    snprintf(element, sizeof element, "meshes[%u]", i);
    triangles[i] = 0;
    cJSON_ArrayForEach(primitive, member(mesh, "primitives")) {
      triangles[i] += primitive_triangles(c, primitive);
      ++*primitives;
    }
    all += triangles[i++];
    OLX_TRY(olx_import_check_limit(scene, OLX_LIMIT_TRIANGLES, all, c->path, element));
  }
  return OLX_OK;
}

// A mesh is made once for every node that has it.
static olx_result check_instances(const checker *c, const olx_scene *scene, const uint64_t *triangles) {
  const cJSON *node = NULL;
  uint64_t all = scene->triangle_count;
  uint32_t i = 0;
  cJSON_ArrayForEach(node, member(c->root, "nodes")) {
    uint32_t mesh = 0;
    bool valid;
    char element[32];
    snprintf(element, sizeof element, "nodes[%u]", i++);
    if (!olx_json_index(member(node, "mesh"), c->mesh_count, &mesh, &valid)) continue;
    all += triangles[mesh];
    OLX_TRY(olx_import_check_limit(scene, OLX_LIMIT_TRIANGLES, all, c->path, element));
  }
  return OLX_OK;
}

// Every image inside the buffers is copied out of them.
static olx_result check_image_bytes(const checker *c) {
  uint64_t available = 0, taken = 0;
  uint32_t i = 0;
  for (uint32_t b = 0; b < c->buffer_count; ++b) {
    uint64_t size_bytes;
    if (read_size(c->buffers[b], "byteLength", 0, &size_bytes)) available += size_bytes;
  }
  const cJSON *image = NULL;
  cJSON_ArrayForEach(image, member(c->root, "images")) {
    uint32_t view = 0;
    bool valid;
    uint64_t size_bytes = 0;
    if (olx_json_index(member(image, "bufferView"), c->view_count, &view, &valid)) {
      read_size(c->views[view], "byteLength", 0, &size_bytes);
    }
    taken += size_bytes;
    if (taken > available) return fail(c, "images", i, "it shares its bytes with other images");
    ++i;
  }
  return OLX_OK;
}

static olx_result check_amounts(const checker *c, const olx_scene *scene) {
  const uint64_t materials = (uint64_t)scene->material_count + c->material_count;
  OLX_TRY(olx_import_check_limit(scene, OLX_LIMIT_MATERIALS, materials, c->path, "materials"));
  OLX_TRY(olx_import_check_limit(scene, OLX_LIMIT_NODES, c->node_count, c->path, "nodes"));
  uint64_t *triangles = olx_allocate(c->mesh_count, sizeof *triangles), primitives = 0;
  if (!triangles) return olx_fail(OLX_ERROR_MEMORY, "%s: out of memory", c->path);
  olx_result result = count_triangles(c, scene, triangles, &primitives);
  if (result == OLX_OK) {
    result =
        olx_import_check_limit(scene, OLX_LIMIT_NODES, c->node_count + primitives, c->path, "nodes and primitives");
  }
  if (result == OLX_OK) result = check_instances(c, scene, triangles);
  olx_release(triangles);
  return result == OLX_OK ? check_image_bytes(c) : result;
}

static olx_result check_all(checker *c, olx_scene *scene) {
  const cJSON *version = member(member(c->root, "asset"), "version");
  if (!cJSON_IsString(version)) return olx_fail(OLX_ERROR_FORMAT, "%s: not a glTF file: no asset.version", c->path);
  if (strncmp(version->valuestring, "2.", 2) != 0) {
    return olx_fail(OLX_ERROR_VERSION, "%s: glTF version %.20s, not 2.x", c->path, version->valuestring);
  }
  OLX_TRY(check_extensions(c, scene));
  OLX_TRY(collect(c, "buffers", &c->buffers, &c->buffer_count));
  OLX_TRY(collect(c, "bufferViews", &c->views, &c->view_count));
  OLX_TRY(collect(c, "accessors", &c->accessors, &c->accessor_count));
  OLX_TRY(collect(c, "materials", NULL, &c->material_count));
  OLX_TRY(collect(c, "meshes", NULL, &c->mesh_count));
  OLX_TRY(collect(c, "nodes", NULL, &c->node_count));
  OLX_TRY(collect(c, "images", NULL, &c->image_count));
  OLX_TRY(collect(c, "textures", NULL, &c->texture_count));
  OLX_TRY(check_views(c));
  for (uint32_t i = 0; i < c->accessor_count; ++i) OLX_TRY(check_accessor(c, i));
  OLX_TRY(check_meshes(c));
  OLX_TRY(check_images(c));
  OLX_TRY(check_nodes(c));
  return check_amounts(c, scene);
}

olx_result olx_gltf_check(const char *path, const cJSON *root, olx_scene *scene) {
  checker c = {.path = path, .root = root};
  const olx_result result = check_all(&c, scene);
  olx_release(c.accessors);
  olx_release(c.views);
  olx_release(c.buffers);
  return result;
}
