// Writes a scene as a binary glTF model (.glb), for renderers that draw it beside its field: triangles by material,
// textures, lights without area, cameras. Positions are relative to the scene's origin, like the field's.
#include "core/hooks.h"
#include "core/result.h"
#include "core/vec.h"
#include "export/gzip_file.h"

#include <octalux/export.h>
#include <octalux/render.h>

#include <cjson/cJSON.h>
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

// glTF's constants, which are OpenGL's.
enum { FLOAT = 5126, UNSIGNED_INT = 5125, ARRAY_BUFFER = 34962, ELEMENT_ARRAY_BUFFER = 34963 };

enum { JPEG_QUALITY = 92 };
enum { GLB_MAGIC = 0x46546C67, GLB_JSON = 0x4E4F534A, GLB_BINARY = 0x004E4942, GLB_HEADER = 12, GLB_CHUNK = 8 };

typedef struct scene_model {
  olx_scene_content content;
  cJSON *root, *nodes, *accessors, *views;
  uint32_t positions, normals, uvs, second_uvs, colors; // indices of accessors; UINT32_MAX: none
  uint8_t *bytes;                                       // of the buffer
  size_t size_bytes, most_bytes;
  bool failed; // out of memory
} scene_model;

typedef struct image_bytes {
  uint8_t *data;
  size_t size_bytes;
  bool is_jpeg;
} image_bytes;

// ---- Buffer

// Reserves bytes at the end of the buffer, whose size is a multiple of four; NULL when memory runs out.
static void *extend(scene_model *m, size_t size_bytes) {
  const size_t begin = (m->size_bytes + 3) / 4 * 4, end = begin + size_bytes;
  if (end > m->most_bytes) {
    uint8_t *bytes = olx_allocate(2 * end, 1);
    if (!bytes) {
      m->failed = true;
      return NULL;
    }
    if (m->size_bytes) memcpy(bytes, m->bytes, m->size_bytes);
    olx_release(m->bytes);
    m->bytes = bytes;
    m->most_bytes = 2 * end;
  }
  memset(m->bytes + m->size_bytes, 0, begin - m->size_bytes);
  m->size_bytes = end;
  return m->bytes + begin;
}

static cJSON *new_object(scene_model *m, cJSON *list) {
  cJSON *object = cJSON_CreateObject();
  if (!object || !cJSON_AddItemToArray(list, object)) m->failed = true;
  return object;
}

static uint32_t size_of(const cJSON *list) { return (uint32_t)cJSON_GetArraySize(list); }

// Adds a view of the last bytes of the buffer; target 0 is for images.
static uint32_t add_view(scene_model *m, size_t bytes, int target) {
  cJSON *view = new_object(m, m->views);
  cJSON_AddNumberToObject(view, "buffer", 0);
  cJSON_AddNumberToObject(view, "byteOffset", (double)(m->size_bytes - bytes));
  cJSON_AddNumberToObject(view, "byteLength", (double)bytes);
  if (target) cJSON_AddNumberToObject(view, "target", target);
  return size_of(m->views) - 1;
}

static uint32_t add_accessor(scene_model *m, uint32_t count, const char *type, int component, int target,
                             size_t element_bytes) {
  const uint32_t view = add_view(m, count * element_bytes, target);
  cJSON *accessor = new_object(m, m->accessors);
  cJSON_AddNumberToObject(accessor, "bufferView", view);
  cJSON_AddNumberToObject(accessor, "componentType", component);
  cJSON_AddNumberToObject(accessor, "count", count);
  cJSON_AddStringToObject(accessor, "type", type);
  return size_of(m->accessors) - 1;
}

static void add_vector(cJSON *object, const char *key, olx_vec3 v) {
  cJSON_AddItemToObject(object, key, cJSON_CreateFloatArray((float[]){v.x, v.y, v.z}, 3));
}

// ---- Vertices

static uint32_t add_vertices(scene_model *m, const void *data, const char *type, size_t element_bytes) {
  if (!data) return UINT32_MAX;
  const uint32_t count = m->content.vertex_count;
  void *to = extend(m, count * element_bytes);
  if (!to) return UINT32_MAX;
  memcpy(to, data, count * element_bytes);
  return add_accessor(m, count, type, FLOAT, ARRAY_BUFFER, element_bytes);
}

static void add_all_vertices(scene_model *m) {
  const olx_scene_content *c = &m->content;
  m->positions = add_vertices(m, c->positions, "VEC3", sizeof *c->positions);
  m->normals = add_vertices(m, c->normals, "VEC3", sizeof *c->normals);
  m->uvs = add_vertices(m, c->uvs, "VEC2", sizeof *c->uvs);
  m->second_uvs = add_vertices(m, c->second_uvs, "VEC2", sizeof *c->second_uvs);
  m->colors = add_vertices(m, c->colors, "VEC4", sizeof *c->colors);
  cJSON *accessor = cJSON_GetArrayItem(m->accessors, (int)m->positions); // bounds, which glTF requires
  add_vector(accessor, "min", c->bounds_min);
  add_vector(accessor, "max", c->bounds_max);
}

// Adds the indices of a material's triangles; UINT32_MAX where it has none.
static uint32_t add_indices(scene_model *m, uint32_t material) {
  const olx_scene_content *c = &m->content;
  uint32_t count = 0;
  for (uint32_t i = 0; i < c->triangle_count; i++) count += c->material_index[i] == material ? 3 : 0;
  uint32_t *to = count ? extend(m, count * sizeof *to) : NULL;
  if (!to) return UINT32_MAX;
  for (uint32_t i = 0; i < c->triangle_count; i++) {
    if (c->material_index[i] != material) continue;
    memcpy(to, &c->indices[3 * i], 3 * sizeof *to);
    to += 3;
  }
  return add_accessor(m, count, "SCALAR", UNSIGNED_INT, ELEMENT_ARRAY_BUFFER, sizeof *to);
}

// ---- Materials

static void add_texture(cJSON *parent, const char *key, const olx_material *material, uint32_t texture, int slot) {
  if (texture == OLX_NO_TEXTURE) return;
  cJSON *info = cJSON_AddObjectToObject(parent, key);
  cJSON_AddNumberToObject(info, "index", texture);
  if (material->second_uvs & (uint32_t)slot) cJSON_AddNumberToObject(info, "texCoord", 1);
}

static void add_surface(cJSON *parent, const olx_material *material) {
  const olx_vec3 c = material->base_color;
  cJSON *surface = cJSON_AddObjectToObject(parent, "pbrMetallicRoughness");
  cJSON_AddItemToObject(surface, "baseColorFactor",
                        cJSON_CreateFloatArray((float[]){c.x, c.y, c.z, material->alpha}, 4));
  cJSON_AddNumberToObject(surface, "metallicFactor", material->metallic);
  cJSON_AddNumberToObject(surface, "roughnessFactor", material->roughness);
  add_texture(surface, "baseColorTexture", material, material->base_color_texture, OLX_SLOT_BASE_COLOR);
  add_texture(surface, "metallicRoughnessTexture", material, material->metallic_roughness_texture,
              OLX_SLOT_METALLIC_ROUGHNESS);
}

// Splits emission: the factor is at most 1, and the strength is what exceeds it.
static void add_emission(cJSON *parent, cJSON *extensions, const olx_material *material) {
  const olx_vec3 e = material->emission;
  const float most = fmaxf(e.x, fmaxf(e.y, e.z));
  if (!(most > 0.0f)) return;
  add_vector(parent, "emissiveFactor", olx_scale(e, 1.0f / most));
  cJSON_AddNumberToObject(cJSON_AddObjectToObject(extensions, "KHR_materials_emissive_strength"), "emissiveStrength",
                          most);
  add_texture(parent, "emissiveTexture", material, material->emission_texture, OLX_SLOT_EMISSION);
}

static void add_material(scene_model *m, cJSON *list, const olx_material *material) {
  cJSON *object = new_object(m, list);
  cJSON_AddStringToObject(object, "name", material->name);
  add_surface(object, material);
  cJSON *extensions = cJSON_AddObjectToObject(object, "extensions");
  cJSON *specular = cJSON_AddObjectToObject(extensions, "KHR_materials_specular");
  cJSON_AddNumberToObject(specular, "specularFactor", material->specular_weight);
  if (material->specular_in_alpha) {
    add_texture(specular, "specularTexture", material, material->metallic_roughness_texture,
                OLX_SLOT_METALLIC_ROUGHNESS);
  }
  add_emission(object, extensions, material);
  cJSON_AddBoolToObject(object, "doubleSided", true); // every triangle is visible from both sides
  if (material->blended) {
    cJSON_AddStringToObject(object, "alphaMode", "BLEND");
  } else if (material->alpha_cutoff > 0.0f) {
    cJSON_AddStringToObject(object, "alphaMode", "MASK");
    cJSON_AddNumberToObject(object, "alphaCutoff", material->alpha_cutoff);
  }
  if (!material->normal_is_height) {
    add_texture(object, "normalTexture", material, material->normal_texture, OLX_SLOT_NORMAL);
    cJSON *normal = cJSON_GetObjectItem(object, "normalTexture");
    if (normal) cJSON_AddNumberToObject(normal, "scale", material->normal_scale);
  }
}

static void add_materials(scene_model *m) {
  static const char *const used[] = {"KHR_materials_specular", "KHR_materials_emissive_strength",
                                     "KHR_lights_punctual"};
  cJSON *list = cJSON_AddArrayToObject(m->root, "materials");
  for (uint32_t i = 0; i < m->content.material_count; i++) add_material(m, list, &m->content.materials[i]);
  cJSON_AddItemToObject(m->root, "extensionsUsed", cJSON_CreateStringArray(used, m->content.light_count ? 3 : 2));
}

// ---- Images

// Returns whether a texture is the colour of opaque surfaces in every material that uses it.
static bool is_opaque_color(const olx_scene_content *c, uint32_t texture) {
  const olx_texture *t = &c->textures[texture];
  for (size_t i = 0; i < (size_t)t->width * t->height; i++) {
    if (t->texels[4 * i + 3] != 255) return false;
  }
  bool is_color = false;
  for (uint32_t i = 0; i < c->material_count; i++) {
    const olx_material *m = &c->materials[i];
    if (m->metallic_roughness_texture == texture || m->normal_texture == texture || m->emission_texture == texture)
      return false;
    is_color = is_color || m->base_color_texture == texture;
  }
  return is_color;
}

// Encodes a texture as PNG, or as JPEG if it is a photograph, of which a JPEG takes less than half as much.
static olx_result encode_image(const scene_model *m, uint32_t texture, image_bytes *image) {
  const olx_texture *t = &m->content.textures[texture];
  image_bytes jpeg = {.is_jpeg = true};
  OLX_TRY(olx_png_encode(t->width, t->height, 4, t->texels, &image->data, &image->size_bytes));
  if (!is_opaque_color(&m->content, texture)) return OLX_OK;
  const olx_result result =
      olx_jpeg_encode(t->width, t->height, 4, t->texels, JPEG_QUALITY, &jpeg.data, &jpeg.size_bytes);
  const bool better = result == OLX_OK && 2 * jpeg.size_bytes < image->size_bytes;
  olx_png_free(better || result != OLX_OK ? image->data : jpeg.data);
  if (better) *image = jpeg;
  return result;
}

static olx_result add_image(scene_model *m, cJSON *images, uint32_t texture) {
  image_bytes encoded = {.data = NULL};
  OLX_TRY(encode_image(m, texture, &encoded));
  void *to = extend(m, encoded.size_bytes);
  if (to) memcpy(to, encoded.data, encoded.size_bytes);
  olx_png_free(encoded.data);
  if (!to) return OLX_OK; // m->failed records it
  cJSON *image = new_object(m, images);
  cJSON_AddStringToObject(image, "mimeType", encoded.is_jpeg ? "image/jpeg" : "image/png");
  cJSON_AddNumberToObject(image, "bufferView", add_view(m, encoded.size_bytes, 0));
  return OLX_OK;
}

static olx_result add_textures(scene_model *m) {
  if (!m->content.texture_count) return OLX_OK;
  cJSON *images = cJSON_AddArrayToObject(m->root, "images"), *textures = cJSON_AddArrayToObject(m->root, "textures");
  for (uint32_t i = 0; i < m->content.texture_count; i++) {
    OLX_TRY(add_image(m, images, i));
    cJSON_AddNumberToObject(new_object(m, textures), "source", i);
  }
  return OLX_OK;
}

// ---- Nodes

static cJSON *add_node(scene_model *m, const char *name) {
  cJSON *node = new_object(m, m->nodes);
  cJSON_AddStringToObject(node, "name", name);
  return node;
}

static void add_primitive(scene_model *m, cJSON *meshes, uint32_t material) {
  const uint32_t indices = add_indices(m, material);
  if (indices == UINT32_MAX) return;
  const olx_material *of = &m->content.materials[material];
  cJSON *mesh = new_object(m, meshes), *primitive = new_object(m, cJSON_AddArrayToObject(mesh, "primitives"));
  cJSON *attributes = cJSON_AddObjectToObject(primitive, "attributes");
  cJSON_AddNumberToObject(attributes, "POSITION", m->positions);
  cJSON_AddNumberToObject(attributes, "NORMAL", m->normals);
  if (m->uvs != UINT32_MAX) cJSON_AddNumberToObject(attributes, "TEXCOORD_0", m->uvs);
  if (m->second_uvs != UINT32_MAX) cJSON_AddNumberToObject(attributes, "TEXCOORD_1", m->second_uvs);
  if (of->vertex_colors && m->colors != UINT32_MAX) cJSON_AddNumberToObject(attributes, "COLOR_0", m->colors);
  cJSON_AddNumberToObject(primitive, "indices", indices);
  cJSON_AddNumberToObject(primitive, "material", material);
  cJSON_AddNumberToObject(add_node(m, of->name), "mesh", size_of(meshes) - 1);
}

// Sets a node's transform: at the position `at`, with -z along `forward`, the viewing direction of glTF's cameras and
// lights.
static void place_node(cJSON *node, olx_vec3 at, olx_vec3 forward, olx_vec3 up) {
  const olx_vec3 z = olx_negate(olx_normalize(forward)), x = olx_normalize(olx_cross(up, z)), y = olx_cross(z, x);
  const float matrix[16] = {x.x, x.y, x.z, 0, y.x, y.y, y.z, 0, z.x, z.y, z.z, 0, at.x, at.y, at.z, 1};
  cJSON_AddItemToObject(node, "matrix", cJSON_CreateFloatArray(matrix, 16));
}

static void add_cameras(scene_model *m) {
  if (!m->content.camera_count) return;
  cJSON *list = cJSON_AddArrayToObject(m->root, "cameras");
  for (uint32_t i = 0; i < m->content.camera_count; i++) {
    const olx_camera *camera = &m->content.cameras[i];
    cJSON *object = new_object(m, list), *lens = cJSON_AddObjectToObject(object, "perspective");
    cJSON_AddStringToObject(object, "type", "perspective");
    cJSON_AddNumberToObject(lens, "yfov", (double)camera->fov_y_degrees * (OLX_PI / 180.0));
    cJSON_AddNumberToObject(lens, "znear", 0.001 * olx_length(olx_sub(m->content.bounds_max, m->content.bounds_min)));
    cJSON *node = add_node(m, camera->name);
    cJSON_AddNumberToObject(node, "camera", i);
    place_node(node, camera->eye, olx_sub(camera->target, camera->eye), camera->up);
  }
}

// Adds a light. Intensities are radiometric; readers take them for candela and lux alike.
static void add_light(scene_model *m, cJSON *list, const olx_light *light) {
  static const char *const types[] = {"directional", "point", "spot"};
  const olx_vec3 e = light->emission;
  const float most = fmaxf(fmaxf(e.x, fmaxf(e.y, e.z)), 1e-20f);
  cJSON *object = new_object(m, list), *node = add_node(m, types[light->type]);
  cJSON_AddStringToObject(object, "type", types[light->type]);
  add_vector(object, "color", olx_scale(e, 1.0f / most));
  cJSON_AddNumberToObject(object, "intensity", most);
  if (light->type == OLX_LIGHT_SPOT) {
    cJSON *spot = cJSON_AddObjectToObject(object, "spot");
    cJSON_AddNumberToObject(spot, "innerConeAngle", acosf(light->cosine_inner));
    cJSON_AddNumberToObject(spot, "outerConeAngle", acosf(light->cosine_outer));
  }
  cJSON *extension = cJSON_AddObjectToObject(cJSON_AddObjectToObject(node, "extensions"), "KHR_lights_punctual");
  cJSON_AddNumberToObject(extension, "light", size_of(list) - 1);
  const olx_vec3 forward = light->type == OLX_LIGHT_POINT ? olx_v3(0.0f, 0.0f, -1.0f) : light->direction;
  const olx_vec3 up = fabsf(forward.y) > 0.9f ? olx_v3(1.0f, 0.0f, 0.0f) : olx_v3(0.0f, 1.0f, 0.0f);
  place_node(node, light->type == OLX_LIGHT_SUN ? olx_v3(0.0f, 0.0f, 0.0f) : light->position, forward, up);
}

static void add_lights(scene_model *m) {
  if (!m->content.light_count) return;
  cJSON *extension = cJSON_AddObjectToObject(cJSON_AddObjectToObject(m->root, "extensions"), "KHR_lights_punctual");
  cJSON *list = cJSON_AddArrayToObject(extension, "lights");
  for (uint32_t i = 0; i < m->content.light_count; i++) add_light(m, list, &m->content.lights[i]);
}

// ---- The file

static void add_root(scene_model *m, cJSON **scene_nodes) {
  cJSON *asset = cJSON_AddObjectToObject(m->root, "asset");
  cJSON_AddStringToObject(asset, "version", "2.0");
  cJSON_AddStringToObject(asset, "generator", "octalux");
  cJSON_AddNumberToObject(m->root, "scene", 0);
  cJSON *scene = new_object(m, cJSON_AddArrayToObject(m->root, "scenes"));
  *scene_nodes = cJSON_AddArrayToObject(scene, "nodes");
  char hash[24];
  snprintf(hash, sizeof hash, "%016" PRIx64, m->content.hash);
  cJSON *extras = cJSON_AddObjectToObject(scene, "extras");
  cJSON_AddStringToObject(extras, "scene_hash", hash);
  cJSON_AddItemToObject(extras, "origin", cJSON_CreateDoubleArray(m->content.origin, 3));
  const olx_environment *environment = m->content.environment;
  add_vector(extras, "sky", environment->texels ? olx_splat(0.0f) : environment->radiance);
  m->nodes = cJSON_AddArrayToObject(m->root, "nodes");
  m->accessors = cJSON_AddArrayToObject(m->root, "accessors");
  m->views = cJSON_AddArrayToObject(m->root, "bufferViews");
}

static olx_result fill_model(scene_model *m) {
  cJSON *scene_nodes = NULL;
  add_root(m, &scene_nodes);
  add_all_vertices(m);
  cJSON *meshes = cJSON_AddArrayToObject(m->root, "meshes");
  for (uint32_t i = 0; i < m->content.material_count; i++) add_primitive(m, meshes, i);
  add_materials(m);
  OLX_TRY(add_textures(m));
  add_cameras(m);
  add_lights(m);
  for (uint32_t i = 0; i < size_of(m->nodes); i++) cJSON_AddItemToArray(scene_nodes, cJSON_CreateNumber(i));
  cJSON *buffer = new_object(m, cJSON_AddArrayToObject(m->root, "buffers"));
  cJSON_AddNumberToObject(buffer, "byteLength", (double)m->size_bytes);
  return OLX_OK;
}

static uint8_t *put_word(uint8_t *to, size_t word) {
  for (uint32_t i = 0; i < 4; i++) *to++ = (uint8_t)(word >> 8 * i);
  return to;
}

static bool ends_in_gz(const char *path) {
  const size_t length = strlen(path);
  return length >= 3 && strcmp(path + length - 3, ".gz") == 0;
}

static olx_result write_gzip(const char *path, const void *data, size_t size_bytes, uint64_t *file_bytes) {
  olx_gzip_file file;
  OLX_TRY(olx_gzip_create(path, &file));
  olx_result result = olx_gzip_write(&file, data, size_bytes);
  if (result == OLX_OK) result = olx_gzip_commit(&file, file_bytes);
  olx_gzip_discard(&file);
  return result;
}

// Writes both chunks, padded to multiples of four: the text with spaces, the buffer with zeros.
static olx_result write_binary(const scene_model *m, const char *text, const char *path, uint64_t *file_bytes) {
  const size_t length = strlen(text), text_bytes = (length + 3) / 4 * 4, data_bytes = (m->size_bytes + 3) / 4 * 4;
  const size_t bytes = GLB_HEADER + 2 * GLB_CHUNK + text_bytes + data_bytes;
  if (bytes > UINT32_MAX) return olx_fail(OLX_ERROR_UNSUPPORTED, "%s: a .glb holds at most 4 GiB", path);
  uint8_t *file = olx_allocate_zero(bytes, 1), *to = file;
  if (!file) return olx_fail(OLX_ERROR_MEMORY, "%s: out of memory", path);
  to = put_word(put_word(put_word(to, GLB_MAGIC), 2), bytes);
  to = put_word(put_word(to, text_bytes), GLB_JSON);
  memset(to, ' ', text_bytes);
  memcpy(to, text, length);
  to = put_word(put_word(to + text_bytes, data_bytes), GLB_BINARY);
  memcpy(to, m->bytes, m->size_bytes);
  if (file_bytes) *file_bytes = bytes;
  const olx_result result =
      ends_in_gz(path) ? write_gzip(path, file, bytes, file_bytes) : olx_write_file(path, file, bytes);
  olx_release(file);
  return result;
}

static olx_result write_model(scene_model *m, const char *path, uint64_t *file_bytes) {
  OLX_TRY(fill_model(m));
  char *text = m->failed ? NULL : cJSON_PrintUnformatted(m->root);
  if (!text) return olx_fail(OLX_ERROR_MEMORY, "%s: out of memory", path);
  const olx_result result = write_binary(m, text, path, file_bytes);
  cJSON_free(text);
  return result;
}

olx_result olx_export_scene(const olx_scene *scene, const char *path, uint64_t *file_bytes) {
  scene_model m = {.content = olx_scene_get_content(scene), .root = cJSON_CreateObject()};
  if (!m.root) return olx_fail(OLX_ERROR_MEMORY, "%s: out of memory", path);
  const olx_result result = write_model(&m, path, file_bytes);
  cJSON_Delete(m.root);
  olx_release(m.bytes);
  return result;
}
