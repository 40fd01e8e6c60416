#include "scene/import_material.h"

#include "core/hooks.h"
#include "core/result.h"
#include "scene/model_files.h"
#include "scene/scene_build.h"

#include <assimp/GltfMaterial.h>
#include <assimp/ObjMaterial.h>
#include <assimp/material.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define LARGEST_ALBEDO 0.95f

typedef struct aiMaterial source_material;

void olx_name_list_add(olx_name_list *list, const char *name) {
  const size_t used = strlen(list->names);
  if (!name[0]) name = "unnamed";
  ++list->count;
  if (used + strlen(name) + 8 < sizeof list->names) {
    snprintf(list->names + used, sizeof list->names - used, "%s%s", used ? ", " : "", name);
  } else if (used + 5 < sizeof list->names && (used < 3 || strcmp(list->names + used - 3, "...") != 0)) {
    snprintf(list->names + used, sizeof list->names - used, ", ...");
  }
}

static float get_float(const source_material *source, const char *key, unsigned type, unsigned index, float otherwise) {
  float value = otherwise;
  return aiGetMaterialFloatArray(source, key, type, index, &value, NULL) == AI_SUCCESS ? value : otherwise;
}

static bool has_float(const source_material *source, const char *key, unsigned type, unsigned index) {
  float value;
  return aiGetMaterialFloatArray(source, key, type, index, &value, NULL) == AI_SUCCESS;
}

static olx_vec3 get_color(const source_material *source, const char *key, unsigned type, unsigned index, float *alpha,
                          olx_vec3 otherwise) {
  struct aiColor4D color = {otherwise.x, otherwise.y, otherwise.z, 1.0f};
  if (aiGetMaterialColor(source, key, type, index, &color) != AI_SUCCESS) return otherwise;
  if (alpha) *alpha = color.a;
  return olx_v3(color.r, color.g, color.b);
}

// Where the texture's file is: beside the model. MTL files from Windows use backslashes, glTF escapes characters with
// %.
static void locate_texture(const char *model_path, const char *name, char *path, size_t size_bytes) {
  const char *slash = strrchr(model_path, '/');
  const int folder = name[0] == '/' || !slash ? 0 : (int)(slash - model_path) + 1;
  snprintf(path, size_bytes, "%.*s%s", folder, model_path, name);
  if (access(path, R_OK) == 0) return;
  char *out = path + folder;
  for (const char *in = out; *in; ++in, ++out) {
    unsigned code;
    if (in[0] == '%' && sscanf(in + 1, "%2x", &code) == 1 && code) {
      *out = (char)code;
      in += 2;
    } else {
      *out = *in == '\\' ? '/' : *in;
    }
  }
  *out = 0;
}

static olx_result request_embedded(olx_material_import *import, const char *name, olx_texture_use use,
                                   uint32_t *number) {
  const unsigned long index = strtoul(name + 1, NULL, 10);
  char label[4200];
  snprintf(label, sizeof label, "%s: embedded image %lu", import->path, index);
  const struct aiTexture *image = index < import->source->mNumTextures ? import->source->mTextures[index] : NULL;
  // Height 0 means that the data are a whole image file of mWidth bytes.
  const bool usable = image && image->mHeight == 0 && image->pcData && image->mWidth > 0;
  return olx_texture_table_request(&import->textures, label, usable ? (const void *)image->pcData : "",
                                   usable ? image->mWidth : 0, use, number);
}

// The uv sets of a material's textures; our scenes keep one set a vertex.
typedef struct uv_choice {
  bool chosen, mixed;
  uint32_t set;
} uv_choice;

static olx_result request_texture(olx_material_import *import, const source_material *source, enum aiTextureType type,
                                  olx_texture_use use, uv_choice *uvs, uint32_t *number) {
  struct aiString name = {0};
  unsigned set = 0;
  *number = OLX_NO_TEXTURE;
  if (aiGetMaterialTexture(source, type, 0, &name, NULL, &set, NULL, NULL, NULL, NULL) != AI_SUCCESS) return OLX_OK;
  if (name.length == 0) return OLX_OK;
  uvs->mixed |= uvs->chosen && uvs->set != set;
  if (!uvs->chosen) *uvs = (uv_choice){.chosen = true, .set = set};
  if (name.data[0] == '*') return request_embedded(import, name.data, use, number);
  char path[8192];
  locate_texture(import->path, name.data, path, sizeof path);
  OLX_TRY(olx_model_file_check(import->scene, import->path, path));
  return olx_texture_table_request(&import->textures, path, NULL, 0, use, number);
}

static olx_result read_gltf(olx_material_import *import, uint32_t index, olx_material *m, uv_choice *uvs) {
  const source_material *source = import->source->mMaterials[index];
  float alpha = 1.0f, emissive_strength;
  m->base_color = get_color(source, AI_MATKEY_BASE_COLOR, &alpha, olx_splat(1.0f));
  m->metallic = get_float(source, AI_MATKEY_METALLIC_FACTOR, 1.0f);
  m->roughness = get_float(source, AI_MATKEY_ROUGHNESS_FACTOR, 1.0f);
  m->normal_scale = get_float(source, AI_MATKEY_GLTF_TEXTURE_SCALE(aiTextureType_NORMALS, 0), 1.0f);
  olx_gltf_material_extensions(import->gltf, index, m->name, &emissive_strength, &m->specular_weight);
  m->emission = olx_scale(get_color(source, AI_MATKEY_COLOR_EMISSIVE, NULL, olx_splat(0.0f)), emissive_strength);
  int two_sided = 0;
  aiGetMaterialIntegerArray(source, AI_MATKEY_TWOSIDED, &two_sided, NULL);
  m->emits_both_sides = two_sided != 0;
  struct aiString mode = {0};
  aiGetMaterialString(source, AI_MATKEY_GLTF_ALPHAMODE, &mode);
  if (strcmp(mode.data, "MASK") == 0) {
    m->alpha = alpha;
    m->alpha_cutoff = get_float(source, AI_MATKEY_GLTF_ALPHACUTOFF, 0.5f);
  } else if (strcmp(mode.data, "BLEND") == 0) {
    m->alpha = alpha;
    m->alpha_cutoff = 0.5f;
    olx_name_list_add(&import->translucent, m->name);
  }
  OLX_TRY(request_texture(import, source, aiTextureType_BASE_COLOR, OLX_TEXTURE_COLOR, uvs, &m->base_color_texture));
  OLX_TRY(
      request_texture(import, source, aiTextureType_UNKNOWN, OLX_TEXTURE_DATA, uvs, &m->metallic_roughness_texture));
  OLX_TRY(request_texture(import, source, aiTextureType_EMISSIVE, OLX_TEXTURE_COLOR, uvs, &m->emission_texture));
  return request_texture(import, source, aiTextureType_NORMALS, OLX_TEXTURE_DATA, uvs, &m->normal_texture);
}

static void read_mtl_opacity(olx_material_import *import, const source_material *source, olx_material *m) {
  m->alpha = get_float(source, AI_MATKEY_OPACITY, 1.0f);
  if (m->alpha < 1.0f) olx_name_list_add(&import->translucent, m->name);
  if (m->alpha < 1.0f || m->alpha_texture != OLX_NO_TEXTURE) m->alpha_cutoff = 0.5f;
}

static olx_result read_mtl(olx_material_import *import, uint32_t index, olx_material *m, uv_choice *uvs) {
  const source_material *source = import->source->mMaterials[index];
  m->base_color = get_color(source, AI_MATKEY_COLOR_DIFFUSE, NULL, olx_splat(0.6f));
  m->emission = get_color(source, AI_MATKEY_COLOR_EMISSIVE, NULL, olx_splat(0.0f));
  m->emits_both_sides = true;
  m->metallic = get_float(source, AI_MATKEY_METALLIC_FACTOR, 0.0f);
  const olx_vec3 ks = get_color(source, AI_MATKEY_COLOR_SPECULAR, NULL, olx_splat(0.0f));
  m->specular_weight = olx_max3(ks) > 0.0f ? 1.0f : 0.0f;
  // Blinn-Phong's exponent as GGX: alpha = sqrt(2 / (Ns + 2)) = roughness^2. An explicit Pr goes first.
  const float exponent = olx_max(get_float(source, AI_MATKEY_SHININESS, 0.0f), 0.0f);
  m->roughness = m->specular_weight > 0.0f ? sqrtf(sqrtf(2.0f / (exponent + 2.0f))) : 1.0f;
  if (has_float(source, AI_MATKEY_ROUGHNESS_FACTOR)) m->roughness = get_float(source, AI_MATKEY_ROUGHNESS_FACTOR, 1.0f);
  OLX_TRY(request_texture(import, source, aiTextureType_DIFFUSE, OLX_TEXTURE_COLOR, uvs, &m->base_color_texture));
  OLX_TRY(request_texture(import, source, aiTextureType_OPACITY, OLX_TEXTURE_COVERAGE, uvs, &m->alpha_texture));
  OLX_TRY(request_texture(import, source, aiTextureType_EMISSIVE, OLX_TEXTURE_COLOR, uvs, &m->emission_texture));
  if (m->emission_texture != OLX_NO_TEXTURE && olx_max3(m->emission) <= 0.0f) m->emission = olx_splat(1.0f);
  OLX_TRY(request_texture(import, source, aiTextureType_NORMALS, OLX_TEXTURE_DATA, uvs, &m->normal_texture));
  if (m->normal_texture == OLX_NO_TEXTURE) {
    OLX_TRY(request_texture(import, source, aiTextureType_HEIGHT, OLX_TEXTURE_DATA, uvs, &m->normal_texture));
    m->normal_is_height = m->normal_texture != OLX_NO_TEXTURE;
    m->normal_scale = get_float(source, AI_MATKEY_OBJ_BUMPMULT_HEIGHT(0), 1.0f);
  }
  read_mtl_opacity(import, source, m);
  return OLX_OK;
}

static bool repair_number(float *value, float low, float high, float otherwise) {
  if (*value >= low && *value <= high) return false;
  *value = isfinite(*value) ? olx_clamp(*value, low, high) : otherwise;
  return true;
}

static bool repair_color(olx_vec3 *color, float high, float otherwise) {
  const bool x = repair_number(&color->x, 0.0f, high, otherwise), y = repair_number(&color->y, 0.0f, high, otherwise);
  return repair_number(&color->z, 0.0f, high, otherwise) || x || y;
}

static void repair_material(olx_material_import *import, olx_material *m) {
  bool repaired = repair_color(&m->base_color, 1.0f, 0.8f);
  repaired |= repair_color(&m->emission, 1e20f, 0.0f);
  repaired |= repair_number(&m->metallic, 0.0f, 1.0f, 0.0f);
  repaired |= repair_number(&m->roughness, 0.0f, 1.0f, 1.0f);
  repaired |= repair_number(&m->alpha, 0.0f, 1.0f, 1.0f);
  repaired |= repair_number(&m->alpha_cutoff, 0.0f, 1e20f, 0.5f);
  repaired |= repair_number(&m->normal_scale, -1e4f, 1e4f, 1.0f);
  if (repaired) olx_name_list_add(&import->repaired, m->name);
  // With a texture, the product is clamped where it is looked up.
  if (m->base_color_texture == OLX_NO_TEXTURE && olx_max3(m->base_color) > LARGEST_ALBEDO) {
    m->base_color = olx_min_each(m->base_color, olx_splat(LARGEST_ALBEDO));
    olx_name_list_add(&import->clamped, m->name);
  }
}

olx_result olx_import_material(olx_material_import *import, uint32_t index, olx_material *material, uint32_t *uv_set) {
  struct aiString name = {0};
  uv_choice uvs = {0};
  *material = olx_material_default();
  aiGetMaterialString(import->source->mMaterials[index], AI_MATKEY_NAME, &name);
  snprintf(material->name, sizeof material->name, "%.127s", name.data);
  OLX_TRY(import->gltf ? read_gltf(import, index, material, &uvs) : read_mtl(import, index, material, &uvs));
  repair_material(import, material);
  if (uvs.mixed) olx_name_list_add(&import->mixed_uvs, material->name);
  *uv_set = uvs.set;
  return OLX_OK;
}
