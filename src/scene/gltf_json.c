#include "scene/gltf_json.h"

#include "core/file.h"
#include "core/hooks.h"
#include "core/result.h"
#include "scene/gltf_check.h"
#include "scene/name_index.h"
#include "scene/scene_build.h"
#include "scene/sources.h"

#include <stdio.h>
#include <string.h>

struct olx_gltf {
  char *path;
  cJSON *root;
  const cJSON **nodes, **meshes, **materials, **cameras, **lights; // elements as arrays
  uint32_t node_count, mesh_count, material_count, camera_count, light_count;
  olx_name_index names;     // of the materials
  uint32_t *material_order; // JSON index of the materials in the order of first use
  uint32_t ordered_count;
};

// In what order Assimp numbers materials: it reads nodes depth first, children before the node's own mesh, and numbers
// every material when a primitive first names it.
typedef struct walk_entry {
  uint32_t node;
  bool children_done;
} walk_entry;

static const cJSON *member(const cJSON *object, const char *key) {
  return cJSON_GetObjectItemCaseSensitive(object, key);
}

static const char *own_name(const cJSON *object) {
  const cJSON *name = member(object, "name");
  return cJSON_IsString(name) ? name->valuestring : "";
}

static olx_result collect_elements(const cJSON *array, const cJSON ***elements, uint32_t *count) {
  *count = cJSON_IsArray(array) ? (uint32_t)cJSON_GetArraySize(array) : 0;
  *elements = olx_allocate(*count, sizeof **elements);
  if (!*elements) return olx_fail(OLX_ERROR_MEMORY, "out of memory");
  uint32_t i = 0;
  const cJSON *element = NULL;
  if (*count) {
    cJSON_ArrayForEach(element, array)(*elements)[i++] = element;
  }
  return OLX_OK;
}

static const cJSON *default_scene(const olx_gltf *gltf) {
  const cJSON *scenes = member(gltf->root, "scenes");
  uint32_t index = 0;
  bool valid;
  olx_json_index(member(gltf->root, "scene"), (uint32_t)cJSON_GetArraySize(scenes), &index, &valid);
  return valid ? cJSON_GetArrayItem(scenes, (int)index) : NULL;
}

static void order_mesh_materials(olx_gltf *gltf, const cJSON *mesh, bool *seen) {
  const cJSON *primitive = NULL;
  cJSON_ArrayForEach(primitive, member(mesh, "primitives")) {
    uint32_t material = 0;
    bool valid;
    if (!olx_json_index(member(primitive, "material"), gltf->material_count, &material, &valid) || seen[material]) {
      continue;
    }
    seen[material] = true;
    gltf->material_order[gltf->ordered_count++] = material;
  }
}

static void push_children(const olx_gltf *gltf, const cJSON *list, walk_entry *stack, uint32_t *depth) {
  const uint32_t first = *depth;
  const cJSON *child = NULL;
  cJSON_ArrayForEach(child, list) {
    uint32_t index = 0;
    bool valid;
    if (*depth < gltf->node_count * 2 && olx_json_index(child, gltf->node_count, &index, &valid)) {
      stack[(*depth)++] = (walk_entry){.node = index};
    }
  }
  // The first child must come off the stack first.
  for (uint32_t low = first, high = *depth; low + 1 < high; ++low) {
    const walk_entry last = stack[--high];
    stack[high] = stack[low];
    stack[low] = last;
  }
}

static olx_result order_materials(olx_gltf *gltf) {
  walk_entry *stack = olx_allocate((size_t)gltf->node_count * 2, sizeof *stack);
  bool *seen = olx_allocate_zero(gltf->material_count, sizeof *seen);
  gltf->material_order = olx_allocate(gltf->material_count, sizeof *gltf->material_order);
  olx_result result = OLX_OK;
  if (stack && seen && gltf->material_order) {
    uint32_t depth = 0;
    push_children(gltf, member(default_scene(gltf), "nodes"), stack, &depth);
    while (depth > 0) {
      walk_entry *top = &stack[depth - 1];
      const cJSON *node = gltf->nodes[top->node];
      uint32_t mesh = 0;
      bool valid;
      if (!top->children_done) {
        top->children_done = true;
        push_children(gltf, member(node, "children"), stack, &depth);
        continue;
      }
      if (olx_json_index(member(node, "mesh"), gltf->mesh_count, &mesh, &valid)) {
        order_mesh_materials(gltf, gltf->meshes[mesh], seen);
      }
      --depth;
    }
  } else {
    result = olx_fail(OLX_ERROR_MEMORY, "%s: out of memory", gltf->path);
  }
  olx_release(stack);
  olx_release(seen);
  return result;
}

// The JSON chunk of a binary file, or the whole of a text file.
static olx_result find_json(const char *path, const olx_mapped_file *file, const char **text, size_t *size_bytes) {
  const char *bytes = file->data;
  *text = bytes;
  *size_bytes = file->size_bytes;
  if (file->size_bytes < 4 || memcmp(bytes, "glTF", 4) != 0) return OLX_OK;
  uint32_t header[5];
  if (file->size_bytes < sizeof header) return olx_fail(OLX_ERROR_FORMAT, "%s: the file ends in its header", path);
  memcpy(header, bytes, sizeof header);
  if (header[1] != 2) return olx_fail(OLX_ERROR_VERSION, "%s: glTF version %u, not 2", path, header[1]);
  if (header[2] > file->size_bytes || header[4] != 0x4E4F534Au || header[3] > file->size_bytes - sizeof header) {
    return olx_fail(OLX_ERROR_FORMAT, "%s: the file ends before its JSON, or holds none", path);
  }
  *text = bytes + sizeof header;
  *size_bytes = header[3];
  return OLX_OK;
}

static olx_result note_buffers(const olx_gltf *gltf, olx_scene *scene) {
  const cJSON *buffer = NULL;
  cJSON_ArrayForEach(buffer, member(gltf->root, "buffers")) {
    const cJSON *uri = member(buffer, "uri");
    if (!cJSON_IsString(uri) || strncmp(uri->valuestring, "data:", 5) == 0) continue;
    OLX_TRY(olx_scene_note_named(scene, gltf->path, uri->valuestring, strlen(uri->valuestring)));
  }
  return OLX_OK;
}

static olx_result open_mapped(const olx_mapped_file *file, olx_scene *scene, olx_gltf *gltf) {
  const char *text;
  size_t size_bytes;
  OLX_TRY(find_json(gltf->path, file, &text, &size_bytes));
  OLX_TRY(olx_json_parse(gltf->path, text, size_bytes, &gltf->root));
  OLX_TRY(olx_gltf_check(gltf->path, gltf->root, scene));
  OLX_TRY(note_buffers(gltf, scene));
  OLX_TRY(collect_elements(member(gltf->root, "nodes"), &gltf->nodes, &gltf->node_count));
  OLX_TRY(collect_elements(member(gltf->root, "meshes"), &gltf->meshes, &gltf->mesh_count));
  OLX_TRY(collect_elements(member(gltf->root, "materials"), &gltf->materials, &gltf->material_count));
  const cJSON *punctual = member(member(gltf->root, "extensions"), "KHR_lights_punctual");
  OLX_TRY(collect_elements(member(gltf->root, "cameras"), &gltf->cameras, &gltf->camera_count));
  OLX_TRY(collect_elements(member(punctual, "lights"), &gltf->lights, &gltf->light_count));
  for (uint32_t i = 0; i < gltf->material_count; ++i) {
    OLX_TRY(olx_name_index_add(&gltf->names, own_name(gltf->materials[i])));
  }
  return order_materials(gltf);
}

olx_result olx_gltf_open(const char *path, olx_scene *scene, olx_gltf **gltf) {
  *gltf = NULL;
  olx_mapped_file file;
  OLX_TRY(olx_map_file(path, &file));
  olx_gltf *opened = olx_allocate_zero(1, sizeof *opened);
  olx_result result = OLX_OK;
  if (!opened || !(opened->path = olx_copy_string(path))) {
    result = olx_fail(OLX_ERROR_MEMORY, "%s: out of memory", path);
  } else {
    result = open_mapped(&file, scene, opened);
  }
  olx_unmap_file(&file);
  if (result == OLX_OK) *gltf = opened;
  else olx_gltf_close(opened);
  return result;
}

void olx_gltf_close(olx_gltf *gltf) {
  if (!gltf) return;
  cJSON_Delete(gltf->root);
  olx_release(gltf->path);
  olx_release(gltf->nodes);
  olx_release(gltf->meshes);
  olx_release(gltf->materials);
  olx_release(gltf->cameras);
  olx_release(gltf->lights);
  olx_name_index_free(&gltf->names);
  olx_release(gltf->material_order);
  olx_release(gltf);
}

static const cJSON *find_material(const olx_gltf *gltf, uint32_t assimp_index, const char *name) {
  if (assimp_index >= gltf->ordered_count) return NULL; // the default material, which Assimp appends
  const cJSON *expected = gltf->materials[gltf->material_order[assimp_index]];
  if (strcmp(own_name(expected), name) == 0) return expected;
  for (uint32_t i = olx_name_index_find(&gltf->names, name, OLX_NO_ELEMENT); i != OLX_NO_ELEMENT;
       i = olx_name_index_find(&gltf->names, name, i)) {
    if (strcmp(own_name(gltf->materials[i]), name) == 0) return gltf->materials[i];
  }
  return NULL;
}

void olx_gltf_material_extensions(const olx_gltf *gltf, uint32_t assimp_index, const char *name,
                                  float *emissive_strength, float *specular_weight) {
  *emissive_strength = *specular_weight = 1.0f;
  const cJSON *extensions = member(find_material(gltf, assimp_index, name), "extensions");
  float value;
  if (olx_json_float(member(member(extensions, "KHR_materials_emissive_strength"), "emissiveStrength"), &value)) {
    *emissive_strength = olx_max(value, 0.0f);
  }
  if (olx_json_float(member(member(extensions, "KHR_materials_specular"), "specularFactor"), &value)) {
    *specular_weight = olx_clamp(value, 0.0f, 1.0f);
  }
}

const cJSON *olx_gltf_roots(const olx_gltf *gltf) { return member(default_scene(gltf), "nodes"); }

const cJSON *olx_gltf_children(const cJSON *node) { return member(node, "children"); }

const cJSON *olx_gltf_node(const olx_gltf *gltf, const cJSON *number) {
  uint32_t index = 0;
  bool valid;
  return olx_json_index(number, gltf->node_count, &index, &valid) ? gltf->nodes[index] : NULL;
}

void olx_gltf_translation(const cJSON *node, double translation[3]) {
  double m[16];
  translation[0] = translation[1] = translation[2] = 0.0;
  if (olx_json_doubles(member(node, "matrix"), m, 16)) memcpy(translation, m + 12, 3 * sizeof *m);
  else olx_json_doubles(member(node, "translation"), translation, 3);
}

static olx_affine linear_transform(const cJSON *node) {
  float m[16], t[3] = {0, 0, 0}, q[4] = {0, 0, 0, 1}, s[3] = {1, 1, 1};
  if (olx_json_floats(member(node, "matrix"), m, 16)) {
    olx_affine a;
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 4; ++column) a.m[row][column] = (double)m[column * 4 + row];
    }
    return a;
  }
  olx_json_floats(member(node, "translation"), t, 3);
  olx_json_floats(member(node, "rotation"), q, 4);
  olx_json_floats(member(node, "scale"), s, 3);
  return olx_affine_from_trs((const double[3]){(double)t[0], (double)t[1], (double)t[2]},
                             (const double[4]){(double)q[0], (double)q[1], (double)q[2], (double)q[3]},
                             (const double[3]){(double)s[0], (double)s[1], (double)s[2]});
}

static olx_affine node_transform(const olx_scene *scene, const cJSON *node) {
  olx_affine transform = linear_transform(node);
  double translation[3];
  olx_gltf_translation(node, translation);
  for (int row = 0; row < 3; ++row) transform.m[row][3] = olx_scene_length(scene, translation[row]);
  return transform;
}

static const char *name_of(const cJSON *node, const cJSON *item, const char *otherwise) {
  const cJSON *names[] = {member(node, "name"), member(item, "name")};
  for (int i = 0; i < 2; ++i) {
    if (cJSON_IsString(names[i]) && names[i]->valuestring[0]) return names[i]->valuestring;
  }
  return otherwise;
}

static olx_result add_camera(const olx_gltf *gltf, const cJSON *node, const cJSON *item, const olx_affine *transform,
                             olx_scene *scene) {
  float fov_y;
  char name[32];
  snprintf(name, sizeof name, "camera %u", scene->camera_count + 1);
  olx_camera camera = {.eye = olx_affine_point(transform, olx_splat(0.0f))};
  snprintf(camera.name, sizeof camera.name, "%s", name_of(node, item, name));
  if (!olx_json_float(member(member(item, "perspective"), "yfov"), &fov_y) || !(fov_y > 0.0f && fov_y < OLX_PI)) {
    olx_scene_warn(scene, "%s: camera \"%s\" skipped: only perspective cameras are supported", gltf->path, camera.name);
    return OLX_OK;
  }
  const olx_vec3 forward = olx_normalize(olx_affine_vector(transform, olx_v3(0.0f, 0.0f, -1.0f)));
  camera.target = olx_add(camera.eye, forward);
  camera.up = olx_normalize(olx_affine_vector(transform, olx_v3(0.0f, 1.0f, 0.0f)));
  camera.fov_y_degrees = fov_y * 180.0f / OLX_PI;
  if (!olx_scene_holds(scene, camera.eye) || !(olx_length(olx_cross(forward, camera.up)) > 1e-3f)) {
    olx_scene_warn(scene, "%s: camera \"%s\" skipped: its transform is degenerate", gltf->path, camera.name);
    return OLX_OK;
  }
  return olx_scene_add_camera(scene, &camera);
}

static olx_result add_light(const olx_gltf *gltf, const cJSON *node, const cJSON *item, const olx_affine *transform,
                            olx_scene *scene) {
  float color[3] = {1.0f, 1.0f, 1.0f}, intensity = 1.0f, inner = 0.0f, outer = OLX_PI / 4.0f;
  const cJSON *type = member(item, "type"), *spot = member(item, "spot");
  const char *kind = cJSON_IsString(type) ? type->valuestring : "", *name = name_of(node, item, "");
  olx_json_floats(member(item, "color"), color, 3);
  olx_json_float(member(item, "intensity"), &intensity);
  olx_json_float(member(spot, "innerConeAngle"), &inner);
  olx_json_float(member(spot, "outerConeAngle"), &outer);
  const bool known = strcmp(kind, "directional") == 0 || strcmp(kind, "point") == 0 || strcmp(kind, "spot") == 0;
  olx_light light = {.type = kind[0] == 'd'   ? OLX_LIGHT_SUN
                             : kind[0] == 'p' ? OLX_LIGHT_POINT
                                              : OLX_LIGHT_SPOT,
                     .position = olx_affine_point(transform, olx_splat(0.0f)),
                     .direction = olx_normalize(olx_affine_vector(transform, olx_v3(0.0f, 0.0f, -1.0f))),
                     .emission = olx_scale(olx_v3(color[0], color[1], color[2]), intensity),
                     .cosine_inner = cosf(inner),
                     .cosine_outer = cosf(outer)};
  const olx_vec3 e = light.emission;
  const bool sane = e.x >= 0.0f && e.y >= 0.0f && e.z >= 0.0f && inner >= 0.0f && inner <= outer && outer <= OLX_PI;
  if (!known || !sane || olx_scene_add_light(scene, &light) != OLX_OK) {
    olx_scene_warn(scene, "%s: light \"%s\" skipped: its type, intensity, cone or transform is not usable", gltf->path,
                   name);
  }
  return OLX_OK;
}

static olx_result add_node(const olx_gltf *gltf, const cJSON *node, const olx_affine *parent, olx_scene *scene) {
  const cJSON *light = member(member(member(node, "extensions"), "KHR_lights_punctual"), "light");
  const olx_affine local = node_transform(scene, node), transform = olx_affine_multiply(parent, &local);
  uint32_t index = 0;
  bool valid;
  if (olx_json_index(member(node, "camera"), gltf->camera_count, &index, &valid)) {
    OLX_TRY(add_camera(gltf, node, gltf->cameras[index], &transform, scene));
  }
  if (olx_json_index(light, gltf->light_count, &index, &valid)) {
    OLX_TRY(add_light(gltf, node, gltf->lights[index], &transform, scene));
  }
  // olx_gltf_check has bounded the depth.
  const cJSON *child = NULL;
  cJSON_ArrayForEach(child, member(node, "children")) {
    if (olx_json_index(child, gltf->node_count, &index, &valid)) {
      OLX_TRY(add_node(gltf, gltf->nodes[index], &transform, scene));
    }
  }
  return OLX_OK;
}

olx_result olx_gltf_add_cameras_and_lights(const olx_gltf *gltf, const olx_affine *placement, olx_scene *scene) {
  const cJSON *root = NULL;
  cJSON_ArrayForEach(root, member(default_scene(gltf), "nodes")) {
    uint32_t index = 0;
    bool valid;
    if (olx_json_index(root, gltf->node_count, &index, &valid)) {
      OLX_TRY(add_node(gltf, gltf->nodes[index], placement, scene));
    }
  }
  return OLX_OK;
}
