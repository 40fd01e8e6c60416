// Opens a glTF file: its two containers, the version, the extensions, and the arrays of elements.
#include "scene/gltf/gltf_document.h"

#include "core/hooks.h"
#include "core/result.h"
#include "scene/scene_build.h"

#include <string.h>

olx_result olx_gltf_fail(const olx_gltf *gltf, const char *list, uint32_t element, const char *what) {
  return olx_fail(OLX_ERROR_FORMAT, "%s: %s[%u]: %s", gltf->path, list, element, what);
}

bool olx_gltf_index(const cJSON *object, const char *key, uint32_t count, uint32_t *index) {
  bool valid;
  *index = OLX_GLTF_NONE;
  olx_json_index(olx_json_member(object, key), count, index, &valid);
  return valid;
}

const cJSON *olx_gltf_extension(const cJSON *element, const char *name) {
  return olx_json_member(olx_json_member(element, "extensions"), name);
}

// ---- Containers

enum { GLB_MAGIC = 0x46546C67, GLB_JSON = 0x4E4F534A, GLB_BINARY = 0x004E4942 };

static uint32_t word_at(const uint8_t *bytes) {
  uint32_t word;
  memcpy(&word, bytes, sizeof word);
  return word;
}

// Finds the binary chunk, which is the second one, if any; `rest` is what follows the JSON.
static olx_result find_binary(olx_gltf *gltf, olx_gltf_bytes rest) {
  if (rest.size_bytes < 8 || word_at(rest.data + 4) != GLB_BINARY) return OLX_OK;
  const uint32_t size_bytes = word_at(rest.data);
  if (size_bytes > rest.size_bytes - 8) {
    return olx_fail(OLX_ERROR_FORMAT, "%s: the file ends inside its binary chunk", gltf->path);
  }
  gltf->binary = (olx_gltf_bytes){rest.data + 8, size_bytes};
  return OLX_OK;
}

static olx_result split_glb(olx_gltf *gltf, olx_gltf_bytes *json) {
  const uint8_t *bytes = gltf->file.data;
  if (gltf->file.size_bytes < 20) return olx_fail(OLX_ERROR_FORMAT, "%s: the file ends in its header", gltf->path);
  const uint32_t version = word_at(bytes + 4), total = word_at(bytes + 8), size_bytes = word_at(bytes + 12);
  if (version != 2) return olx_fail(OLX_ERROR_VERSION, "%s: glTF version %u, not 2", gltf->path, version);
  if (total > gltf->file.size_bytes || total < 20 || word_at(bytes + 16) != GLB_JSON || size_bytes > total - 20) {
    return olx_fail(OLX_ERROR_FORMAT, "%s: the file ends before its JSON, or holds none", gltf->path);
  }
  *json = (olx_gltf_bytes){bytes + 20, size_bytes};
  return find_binary(gltf, (olx_gltf_bytes){bytes + 20 + size_bytes, total - 20 - size_bytes});
}

static olx_result parse_json(olx_gltf *gltf) {
  olx_gltf_bytes json = {gltf->file.data, gltf->file.size_bytes};
  if (json.size_bytes >= 4 && word_at(json.data) == GLB_MAGIC) OLX_TRY(split_glb(gltf, &json));
  return olx_json_parse(gltf->path, (const char *)json.data, json.size_bytes, &gltf->root);
}

// ---- Version and extensions

static const char *const supported_extensions[] = {"EXT_mesh_gpu_instancing",
                                                   "EXT_meshopt_compression",
                                                   "EXT_texture_webp",
                                                   "KHR_draco_mesh_compression",
                                                   "KHR_lights_punctual",
                                                   "KHR_materials_emissive_strength",
                                                   "KHR_materials_pbrSpecularGlossiness",
                                                   "KHR_materials_specular",
                                                   "KHR_materials_transmission",
                                                   "KHR_mesh_quantization",
                                                   "KHR_meshopt_compression",
                                                   "KHR_texture_transform",
                                                   "MESHOPT_compression"};
// Extensions that change at most the look of a material, so that a scene can be used without them.
static const char *const ignored_extensions[] = {
    "KHR_materials_anisotropy",  "KHR_materials_clearcoat", "KHR_materials_dispersion", "KHR_materials_ior",
    "KHR_materials_iridescence", "KHR_materials_sheen",     "KHR_materials_unlit",      "KHR_materials_variants",
    "KHR_materials_volume",      "KHR_xmp_json_ld"};

static bool listed(const char *name, const char *const *list, size_t count) {
  for (size_t i = 0; i < count; ++i) {
    if (strcmp(name, list[i]) == 0) return true;
  }
  return false;
}

#define LISTED(name, list) listed((name), (list), sizeof(list) / sizeof *(list))

// Returns how a file that needs an extension is made readable, as the end of a message.
static const char *remedy_for(const char *extension) {
  if (strncmp(extension, "EXT_texture_", 12) == 0 || strcmp(extension, "KHR_texture_basisu") == 0) {
    return ": export the model again with textures in PNG, JPEG or WebP";
  }
  return "";
}

static olx_result check_required(const olx_gltf *gltf) {
  const cJSON *name = NULL;
  cJSON_ArrayForEach(name, olx_json_member(gltf->root, "extensionsRequired")) {
    if (!cJSON_IsString(name)) {
      return olx_fail(OLX_ERROR_FORMAT, "%s: extensionsRequired: not a list of names", gltf->path);
    }
    if (!LISTED(name->valuestring, supported_extensions) && !LISTED(name->valuestring, ignored_extensions)) {
      return olx_fail(OLX_ERROR_UNSUPPORTED, "%s: the file needs the glTF extension %.100s, which is not supported%s",
                      gltf->path, name->valuestring, remedy_for(name->valuestring));
    }
  }
  return OLX_OK;
}

static void warn_about_ignored(const olx_gltf *gltf) {
  uint32_t ignored = 0;
  const cJSON *name = NULL;
  cJSON_ArrayForEach(name, olx_json_member(gltf->root, "extensionsUsed")) {
    if (!cJSON_IsString(name) || LISTED(name->valuestring, supported_extensions) || ++ignored > 32) continue;
    olx_scene_warn(gltf->scene, "%s: the glTF extension %.100s is ignored", gltf->path, name->valuestring);
  }
}

static olx_result check_asset(const olx_gltf *gltf) {
  const cJSON *asset = olx_json_member(gltf->root, "asset");
  const char *version = olx_json_text(asset, "version");
  if (!version[0]) return olx_fail(OLX_ERROR_FORMAT, "%s: not a glTF file: no asset.version", gltf->path);
  if (strncmp(version, "2.", 2) != 0) {
    return olx_fail(OLX_ERROR_VERSION, "%s: glTF version %.20s, not 2.x", gltf->path, version);
  }
  OLX_TRY(check_required(gltf));
  warn_about_ignored(gltf);
  return OLX_OK;
}

// ---- Elements

static olx_result collect(const olx_gltf *gltf, const cJSON *parent, const char *key, olx_gltf_list *list) {
  const cJSON *array = olx_json_member(parent, key), *element = NULL;
  if (array && !cJSON_IsArray(array)) return olx_fail(OLX_ERROR_FORMAT, "%s: %s: not an array", gltf->path, key);
  list->elements = olx_allocate((size_t)cJSON_GetArraySize(array), sizeof(const cJSON *));
  if (!list->elements) return olx_fail(OLX_ERROR_MEMORY, "%s: out of memory", gltf->path);
  cJSON_ArrayForEach(element, array) {
    if (!cJSON_IsObject(element)) return olx_gltf_fail(gltf, key, list->count, "not an object");
    list->elements[list->count++] = element;
  }
  return OLX_OK;
}

static olx_result collect_all(olx_gltf *gltf) {
  const struct {
    const char *key;
    olx_gltf_list *list;
  } lists[] = {{"buffers", &gltf->buffers},     {"bufferViews", &gltf->views}, {"accessors", &gltf->accessors},
               {"materials", &gltf->materials}, {"meshes", &gltf->meshes},     {"nodes", &gltf->nodes},
               {"scenes", &gltf->scenes},       {"images", &gltf->images},     {"textures", &gltf->textures},
               {"samplers", &gltf->samplers},   {"skins", &gltf->skins},       {"cameras", &gltf->cameras}};
  for (size_t i = 0; i < sizeof lists / sizeof *lists; ++i) {
    OLX_TRY(collect(gltf, gltf->root, lists[i].key, lists[i].list));
  }
  return collect(gltf, olx_gltf_extension(gltf->root, "KHR_lights_punctual"), "lights", &gltf->lights);
}

olx_result olx_gltf_open(const char *path, olx_scene *scene, olx_gltf *gltf) {
  *gltf = (olx_gltf){.path = path, .scene = scene};
  OLX_TRY(olx_map_file(path, &gltf->file));
  OLX_TRY(parse_json(gltf));
  OLX_TRY(check_asset(gltf));
  return collect_all(gltf);
}

void olx_gltf_close(olx_gltf *gltf) {
  void *const lists[] = {gltf->buffers.elements,   gltf->views.elements,  gltf->accessors.elements,
                         gltf->materials.elements, gltf->meshes.elements, gltf->nodes.elements,
                         gltf->scenes.elements,    gltf->images.elements, gltf->textures.elements,
                         gltf->samplers.elements,  gltf->skins.elements,  gltf->cameras.elements,
                         gltf->lights.elements};
  for (size_t i = 0; i < sizeof lists / sizeof *lists; ++i) olx_release(lists[i]);
  cJSON_Delete(gltf->root);
  olx_unmap_file(&gltf->file);
}
