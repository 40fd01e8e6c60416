// Converts the materials of MTL files, as Assimp reads them, to a scene's.
#include "scene/obj/mtl_material.h"

#include "core/name.h"
#include "core/result.h"
#include "scene/scene_build.h"

#include <assimp/ObjMaterial.h>
#include <assimp/material.h>

#include <math.h>

typedef struct aiMaterial source_material;

static float get_float(const source_material *source, const char *key, unsigned type, unsigned index, float otherwise) {
  float value = otherwise;
  return aiGetMaterialFloatArray(source, key, type, index, &value, NULL) == AI_SUCCESS ? value : otherwise;
}

static bool has_float(const source_material *source, const char *key, unsigned type, unsigned index) {
  float value;
  return aiGetMaterialFloatArray(source, key, type, index, &value, NULL) == AI_SUCCESS;
}

static olx_vec3 get_color(const source_material *source, const char *key, unsigned type, unsigned index,
                          olx_vec3 otherwise) {
  struct aiColor4D color = {otherwise.x, otherwise.y, otherwise.z, 1.0f};
  if (aiGetMaterialColor(source, key, type, index, &color) != AI_SUCCESS) return otherwise;
  return olx_v3(color.r, color.g, color.b);
}

static olx_result request_texture(olx_material_import *import, const source_material *source, enum aiTextureType type,
                                  olx_texture_use use, uint32_t *number) {
  struct aiString name = {0};
  *number = OLX_NO_TEXTURE;
  if (aiGetMaterialTexture(source, type, 0, &name, NULL, NULL, NULL, NULL, NULL, NULL) != AI_SUCCESS) return OLX_OK;
  return name.length ? olx_import_texture_file(import, name.data, use, number) : OLX_OK;
}

static void read_mtl_opacity(olx_material_import *import, const source_material *source, olx_material *m) {
  m->alpha = get_float(source, AI_MATKEY_OPACITY, 1.0f);
  if (m->alpha < 1.0f) olx_import_blend(import, m);
  else if (m->alpha_texture != OLX_NO_TEXTURE) m->alpha_cutoff = 0.5f;
}

static olx_result read_mtl(olx_material_import *import, const source_material *source, olx_material *m) {
  m->base_color = get_color(source, AI_MATKEY_COLOR_DIFFUSE, olx_splat(0.6f));
  m->emission = get_color(source, AI_MATKEY_COLOR_EMISSIVE, olx_splat(0.0f));
  m->emits_both_sides = true;
  m->metallic = get_float(source, AI_MATKEY_METALLIC_FACTOR, 0.0f);
  const olx_vec3 ks = get_color(source, AI_MATKEY_COLOR_SPECULAR, olx_splat(0.0f));
  m->specular_weight = olx_max3(ks) > 0.0f ? 1.0f : 0.0f;
  // Converts Blinn-Phong's exponent to GGX: alpha = sqrt(2 / (Ns + 2)) = roughness^2. An explicit Pr takes precedence.
  const float exponent = olx_max(get_float(source, AI_MATKEY_SHININESS, 0.0f), 0.0f);
  m->roughness = m->specular_weight > 0.0f ? sqrtf(sqrtf(2.0f / (exponent + 2.0f))) : 1.0f;
  if (has_float(source, AI_MATKEY_ROUGHNESS_FACTOR)) m->roughness = get_float(source, AI_MATKEY_ROUGHNESS_FACTOR, 1.0f);
  OLX_TRY(request_texture(import, source, aiTextureType_DIFFUSE, OLX_TEXTURE_OPAQUE, &m->base_color_texture));
  OLX_TRY(request_texture(import, source, aiTextureType_OPACITY, OLX_TEXTURE_COVERAGE, &m->alpha_texture));
  OLX_TRY(request_texture(import, source, aiTextureType_EMISSIVE, OLX_TEXTURE_OPAQUE, &m->emission_texture));
  OLX_TRY(request_texture(import, source, aiTextureType_NORMALS, OLX_TEXTURE_DATA, &m->normal_texture));
  if (m->normal_texture == OLX_NO_TEXTURE) {
    OLX_TRY(request_texture(import, source, aiTextureType_HEIGHT, OLX_TEXTURE_DATA, &m->normal_texture));
    m->normal_is_height = m->normal_texture != OLX_NO_TEXTURE;
    m->normal_scale = get_float(source, AI_MATKEY_OBJ_BUMPMULT_HEIGHT(0), 1.0f);
  }
  read_mtl_opacity(import, source, m);
  return OLX_OK;
}

void olx_finish_mtl(olx_material *material) {
  const bool dark = olx_max3(material->emission) <= 0.0f;
  if (dark && material->emission_texture != OLX_NO_TEXTURE) material->emission = olx_splat(1.0f);
}

olx_result olx_import_mtl(olx_material_import *import, const struct aiMaterial *source, olx_material *material) {
  struct aiString name = {0};
  *material = olx_material_default();
  aiGetMaterialString(source, AI_MATKEY_NAME, &name);
  olx_copy_name(name.data, material->name, sizeof material->name);
  OLX_TRY(read_mtl(import, source, material));
  olx_import_repair_material(import, material, false);
  return OLX_OK;
}
