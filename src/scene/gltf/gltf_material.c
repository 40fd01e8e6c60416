// Imports glTF materials. The metallic-roughness model is Octalux's own; extensions are used as far as Octalux's
// materials support them, and otherwise named in a warning.
#include "scene/gltf/gltf_material.h"

#include "core/name.h"
#include "core/result.h"
#include "scene/scene_build.h"

#include <stdio.h>
#include <string.h>

// The material that is being read. `index` is OLX_GLTF_NONE for the default material of primitives without one.
typedef struct material_reader {
  olx_gltf *gltf;
  olx_material_import *import, *merging; // merging: with textures to merge, which the scene gets no other way
  uint32_t index;
  olx_material *material;
  olx_gltf_surface *surface;
  bool crowded;  // a texture would need a third placement
  bool repaired; // a number of an extension was outside its range
} material_reader;

static float number_of(const cJSON *object, const char *key, float otherwise) {
  float number = otherwise;
  olx_json_float(olx_json_member(object, key), &number);
  return number;
}

static olx_vec3 color_of(const cJSON *object, const char *key, float otherwise) {
  float c[3] = {otherwise, otherwise, otherwise};
  olx_json_floats(olx_json_member(object, key), c, 3);
  return olx_load3(c);
}

// Clamps a number of an extension to 0..most, which the extension prescribes.
static float clamp_number(material_reader *r, float number, float most) {
  const float clamped = olx_clamp(number, 0.0f, most);
  r->repaired = r->repaired || clamped != number;
  return clamped;
}

static olx_vec3 clamp_color(material_reader *r, olx_vec3 c, float most) {
  return olx_v3(clamp_number(r, c.x, most), clamp_number(r, c.y, most), clamp_number(r, c.z, most));
}

static olx_result request(material_reader *r, const cJSON *info, const char *key, olx_texture_use use,
                          uint32_t *number) {
  uint32_t texture;
  if (olx_gltf_index(info, "index", r->gltf->textures.count, &texture) && texture != OLX_GLTF_NONE) {
    return olx_gltf_request_texture(r->gltf, r->import, texture, use, number);
  }
  return olx_fail(OLX_ERROR_FORMAT, "%s: materials[%u]: the texture of its %s does not exist", r->gltf->path, r->index,
                  key);
}

// Reads the texture of a material's member, and which texture coordinates it uses.
static olx_result read_texture(material_reader *r, const cJSON *parent, const char *key, olx_texture_use use,
                               olx_texture_slot slot, uint32_t *number) {
  const cJSON *info = olx_json_member(parent, key);
  if (!info) return OLX_OK;
  OLX_TRY(request(r, info, key, use, number));
  if (*number == OLX_NO_TEXTURE) return OLX_OK;
  const olx_gltf_placement place = olx_gltf_read_placement(info);
  uint32_t which;
  if (!olx_gltf_find_placement(&r->surface->placements, &place, &which)) r->crowded = true;
  else if (which == 1) r->material->second_uvs |= slot;
  return OLX_OK;
}

static olx_result read_shared_textures(material_reader *r, const cJSON *element) {
  olx_material *m = r->material;
  OLX_TRY(read_texture(r, element, "emissiveTexture", OLX_TEXTURE_COLOR, OLX_SLOT_EMISSION, &m->emission_texture));
  return read_texture(r, element, "normalTexture", OLX_TEXTURE_DATA, OLX_SLOT_NORMAL, &m->normal_texture);
}

static void read_alpha(const material_reader *r, const cJSON *element, float alpha) {
  const char *mode = olx_json_text(element, "alphaMode");
  const bool mask = strcmp(mode, "MASK") == 0, blend = strcmp(mode, "BLEND") == 0;
  if (!mask && !blend) return;
  r->material->alpha = alpha;
  if (blend) olx_import_blend(r->import, r->material);
  else r->material->alpha_cutoff = number_of(element, "alphaCutoff", 0.5f);
}

// Returns whether all of a surface is metal, whatever its textures contain.
static bool is_metal(const material_reader *r) {
  const bool varies =
      r->material->metallic_roughness_texture != OLX_NO_TEXTURE || r->surface->merged || r->surface->converted;
  return r->material->metallic >= 1.0f && !varies;
}

// Reads what a thin surface transmits, which becomes missing opacity once its textures are there. A mask keeps its
// cutoff, and a surface emits only where it is opaque, so that masks and emitters transmit nothing.
static void read_transmission(material_reader *r, const cJSON *element) {
  const cJSON *extension = olx_gltf_extension(element, "KHR_materials_transmission");
  const float factor = clamp_number(r, number_of(extension, "transmissionFactor", 0.0f), 1.0f);
  olx_material *m = r->material;
  if (!(factor > 0.0f) || is_metal(r)) return;
  if (strcmp(olx_json_text(element, "alphaMode"), "MASK") == 0 || olx_max3(m->emission) > 0.0f ||
      olx_json_member(extension, "transmissionTexture")) {
    olx_name_list_add(&r->import->glazed, m->name);
    return;
  }
  r->surface->glass = (olx_gltf_glass){.transmission = factor, .keeps_alpha = m->blended, .color = m->base_color};
  if (!m->blended) olx_import_blend(r->import, m);
}

// A texture that is merged with others: its place in the material, and its key there.
typedef struct merged_texture {
  const cJSON *parent;
  const char *key;
  olx_texture_use use;
} merged_texture;

static bool lie_together(const merged_texture *parts, uint32_t count) {
  olx_gltf_placement first, next;
  bool any = false, together = true;
  for (uint32_t i = 0; i < count; ++i) {
    const cJSON *info = olx_json_member(parts[i].parent, parts[i].key);
    if (!info) continue;
    next = olx_gltf_read_placement(info);
    if (!any) first = next;
    any = true;
    together = together && olx_gltf_same_placement(&first, &next);
  }
  return together;
}

static olx_result read_specular_textures(material_reader *r, const cJSON *element, const cJSON *specular) {
  const merged_texture parts[OLX_SPECULAR_IMAGES] = {
      [OLX_SPECULAR_SURFACE] = {olx_json_member(element, "pbrMetallicRoughness"), "metallicRoughnessTexture",
                                OLX_TEXTURE_DATA},
      [OLX_SPECULAR_FACTOR] = {specular, "specularTexture", OLX_TEXTURE_DATA},
      [OLX_SPECULAR_COLOR] = {specular, "specularColorTexture", OLX_TEXTURE_COLOR}};
  r->surface->merged = lie_together(parts, OLX_SPECULAR_IMAGES);
  if (!r->surface->merged) {
    olx_name_list_add(&r->import->displaced, r->material->name);
    return OLX_OK;
  }
  material_reader reader = *r;
  reader.import = r->merging;
  for (uint32_t i = 0; i < OLX_SPECULAR_IMAGES; ++i) {
    uint32_t *image = &r->surface->specular.images[i];
    *image = OLX_NO_TEXTURE;
    OLX_TRY(read_texture(&reader, parts[i].parent, parts[i].key, parts[i].use, OLX_SLOT_METALLIC_ROUGHNESS, image));
  }
  r->crowded = reader.crowded;
  return OLX_OK;
}

static olx_result read_specular(material_reader *r, const cJSON *element) {
  const cJSON *specular = olx_gltf_extension(element, "KHR_materials_specular");
  const olx_vec3 color = clamp_color(r, color_of(specular, "specularColorFactor", 1.0f), INFINITY);
  const bool colored = olx_json_member(specular, "specularColorTexture");
  const float factor = clamp_number(r, number_of(specular, "specularFactor", 1.0f), 1.0f);
  r->surface->specular = (olx_gltf_specular){.color = color, .factor = factor};
  r->material->specular_weight = olx_gltf_specular_weight(factor, color);
  if (colored || color.x != 1.0f || color.y != 1.0f || color.z != 1.0f) {
    olx_name_list_add(&r->import->tinted, r->material->name);
  }
  if (!colored && !olx_json_member(specular, "specularTexture")) return OLX_OK;
  return read_specular_textures(r, element, specular);
}

static olx_result read_metallic_roughness(material_reader *r, const cJSON *element) {
  const cJSON *pbr = olx_json_member(element, "pbrMetallicRoughness");
  olx_material *m = r->material;
  float base_color[4] = {1.0f, 1.0f, 1.0f, 1.0f};
  olx_json_floats(olx_json_member(pbr, "baseColorFactor"), base_color, 4);
  m->base_color = olx_load3(base_color);
  m->metallic = number_of(pbr, "metallicFactor", 1.0f);
  m->roughness = number_of(pbr, "roughnessFactor", 1.0f);
  read_alpha(r, element, base_color[3]);
  OLX_TRY(read_specular(r, element));
  OLX_TRY(read_texture(r, pbr, "baseColorTexture", OLX_TEXTURE_COLOR, OLX_SLOT_BASE_COLOR, &m->base_color_texture));
  if (r->surface->merged) return OLX_OK;
  return read_texture(r, pbr, "metallicRoughnessTexture", OLX_TEXTURE_DATA, OLX_SLOT_METALLIC_ROUGHNESS,
                      &m->metallic_roughness_texture);
}

// Reads the textures that a material of the extension is converted from. A diffuse colour alone is the base colour of a
// dielectric as it is; what else there is is converted texel by texel.
static olx_result read_glossy_textures(material_reader *r, const cJSON *glossy) {
  const merged_texture parts[] = {{glossy, "diffuseTexture", OLX_TEXTURE_COLOR},
                                  {glossy, "specularGlossinessTexture", OLX_TEXTURE_COLOR}};
  const bool reflects = olx_json_member(glossy, parts[1].key);
  olx_gltf_glossy_images *images = &r->surface->glossy;
  if (reflects && !lie_together(parts, 2)) olx_name_list_add(&r->import->displaced, r->material->name);
  else r->surface->converted = reflects || r->material->metallic > 0.0f;
  if (!r->surface->converted) {
    return read_texture(r, glossy, parts[0].key, parts[0].use, OLX_SLOT_BASE_COLOR, &r->material->base_color_texture);
  }
  material_reader reader = *r;
  reader.import = r->merging;
  images->diffuse = images->specular = OLX_NO_TEXTURE;
  OLX_TRY(read_texture(&reader, glossy, parts[0].key, parts[0].use, OLX_SLOT_BASE_COLOR, &images->diffuse));
  OLX_TRY(read_texture(&reader, glossy, parts[1].key, parts[1].use, OLX_SLOT_METALLIC_ROUGHNESS, &images->specular));
  r->crowded = reader.crowded;
  return OLX_OK;
}

static olx_result read_glossiness(material_reader *r, const cJSON *element, const cJSON *glossy) {
  float diffuse[4] = {1.0f, 1.0f, 1.0f, 1.0f};
  olx_json_floats(olx_json_member(glossy, "diffuseFactor"), diffuse, 4);
  const olx_gltf_glossiness factors = {clamp_color(r, olx_load3(diffuse), 1.0f),
                                       clamp_color(r, color_of(glossy, "specularFactor", 1.0f), 1.0f),
                                       clamp_number(r, number_of(glossy, "glossinessFactor", 1.0f), 1.0f)};
  const olx_gltf_converted converted = olx_gltf_convert_glossiness(&factors);
  r->surface->glossy.factors = factors;
  r->material->base_color = converted.base_color;
  r->material->metallic = converted.metallic;
  r->material->roughness = converted.roughness;
  r->material->specular_weight = converted.specular_weight;
  read_alpha(r, element, diffuse[3]);
  return read_glossy_textures(r, glossy);
}

static olx_result read_material(material_reader *r, const cJSON *element) {
  olx_material *m = r->material;
  *m = olx_material_default();
  olx_copy_name(olx_json_text(element, "name"), m->name, sizeof m->name);
  m->normal_scale = number_of(olx_json_member(element, "normalTexture"), "scale", 1.0f);
  const cJSON *strength = olx_gltf_extension(element, "KHR_materials_emissive_strength");
  m->emission = olx_scale(color_of(element, "emissiveFactor", 0.0f),
                          clamp_number(r, number_of(strength, "emissiveStrength", 1.0f), INFINITY));
  m->emits_both_sides = cJSON_IsTrue(olx_json_member(element, "doubleSided"));
  const cJSON *glossy = olx_gltf_extension(element, "KHR_materials_pbrSpecularGlossiness");
  OLX_TRY(glossy ? read_glossiness(r, element, glossy) : read_metallic_roughness(r, element));
  read_transmission(r, element);
  OLX_TRY(read_shared_textures(r, element));
  if (r->crowded) olx_name_list_add(&r->import->crowded, m->name);
  return OLX_OK;
}

static olx_result import_material(olx_gltf *gltf, olx_material_import *import, olx_material_import *merging,
                                  uint32_t index, olx_gltf_surface *surface) {
  olx_material material;
  material_reader reader = {
      .gltf = gltf, .import = import, .merging = merging, .index = index, .material = &material, .surface = surface};
  OLX_TRY(read_material(&reader, index < gltf->materials.count ? gltf->materials.elements[index] : NULL));
  olx_import_repair_material(import, &material, reader.repaired);
  // Texture coordinates that no texture uses are unchanged.
  if (!surface->placements.count) {
    const olx_gltf_placement plain = olx_gltf_read_placement(NULL);
    surface->placements = (olx_gltf_placements){.count = 1, .places = {plain}};
  }
  surface->absent = olx_material_absent(&material);
  return olx_scene_add_material(gltf->scene, &material, &surface->material);
}

// Returns whether two surfaces merge the same images in the same way.
static bool merge_alike(const olx_gltf_surface *a, const olx_gltf_surface *b) {
  return a->merged == b->merged && a->converted == b->converted &&
         memcmp(&a->specular, &b->specular, sizeof a->specular) == 0 &&
         memcmp(&a->glossy, &b->glossy, sizeof a->glossy) == 0;
}

// Gives a material what another one got by merging the same images.
static void share_merged(const olx_material *made, bool converted, olx_material *material) {
  material->metallic_roughness_texture = made->metallic_roughness_texture;
  material->specular_in_alpha = made->specular_in_alpha;
  if (!converted) return;
  material->base_color = made->base_color;
  material->metallic = made->metallic;
  material->roughness = made->roughness;
  material->specular_weight = made->specular_weight;
  material->base_color_texture = made->base_color_texture;
}

static olx_result merge_images(olx_gltf *gltf, const olx_material_import *merging, const olx_gltf_surface *surface,
                               uint32_t index) {
  olx_material *material = &gltf->scene->materials[surface->material];
  char element[32];
  snprintf(element, sizeof element, "materials[%u]", index);
  return surface->converted ? olx_gltf_merge_glossiness(&surface->glossy, &merging->textures, gltf->path, element,
                                                        gltf->scene, material)
                            : olx_gltf_merge_specular(&surface->specular, &merging->textures, gltf->path, element,
                                                      gltf->scene, material);
}

// Decodes and merges the textures of materials that need it. Materials with the same ones share the result.
static olx_result merge_textures(olx_gltf *gltf, olx_material_import *merging, const olx_gltf_surface *surfaces) {
  OLX_TRY(olx_texture_table_decode(&merging->textures, gltf->path, gltf->scene));
  for (uint32_t i = 0; i <= gltf->materials.count; ++i) {
    uint32_t same = 0;
    if (!surfaces[i].merged && !surfaces[i].converted) continue;
    while (!merge_alike(&surfaces[same], &surfaces[i])) same++;
    const olx_material *made = &gltf->scene->materials[surfaces[same].material];
    // Where an image could not be merged, each material that has it gets a warning of its own.
    if (same == i || (surfaces[i].merged && !made->specular_in_alpha)) {
      OLX_TRY(merge_images(gltf, merging, &surfaces[i], i));
    } else {
      share_merged(made, surfaces[i].converted, &gltf->scene->materials[surfaces[i].material]);
    }
  }
  return OLX_OK;
}

// Gives the materials that transmit light their opacity. Those of the same glass share a texture.
static olx_result apply_glass(olx_gltf *gltf, olx_gltf_surface *surfaces) {
  for (uint32_t i = 0; i <= gltf->materials.count; ++i) {
    olx_gltf_glass *glass = &surfaces[i].glass;
    if (!(glass->transmission > 0.0f)) continue;
    olx_material *material = &gltf->scene->materials[surfaces[i].material];
    olx_gltf_find_glass(material, glass);
    uint32_t same = 0;
    while (same < i && !olx_gltf_same_glass(&surfaces[same].glass, glass)) same++;
    char element[32];
    snprintf(element, sizeof element, "materials[%u]", i);
    if (same < i) olx_gltf_share_glass(glass, &gltf->scene->materials[surfaces[same].material], material);
    else OLX_TRY(olx_gltf_apply_glass(glass, gltf->path, element, gltf->scene, material));
    surfaces[i].absent = olx_material_absent(material);
  }
  return OLX_OK;
}

olx_result olx_gltf_import_materials(olx_gltf *gltf, olx_gltf_surface *surfaces) {
  olx_material_import import = {.path = gltf->path, .scene = gltf->scene}, merging = import;
  const uint32_t first = gltf->scene->material_count;
  olx_result result = OLX_OK;
  for (uint32_t i = 0; i <= gltf->materials.count && result == OLX_OK; ++i) {
    if (surfaces[i].used) result = import_material(gltf, &import, &merging, i, &surfaces[i]);
  }
  if (result == OLX_OK) result = olx_import_load_textures(&import, first);
  if (result == OLX_OK) result = merge_textures(gltf, &merging, surfaces);
  if (result == OLX_OK) result = apply_glass(gltf, surfaces);
  if (result == OLX_OK) olx_import_warn_about_materials(&import);
  if (result == OLX_OK && surfaces[gltf->materials.count].used) {
    olx_scene_warn(gltf->scene,
                   "%s: surfaces without a material are white metal, as glTF has it: \"metallic\": 0 for \"*\" in a "
                   "description makes them matte",
                   gltf->path);
  }
  olx_texture_table_free(&import.textures);
  olx_texture_table_free(&merging.textures);
  return result;
}
