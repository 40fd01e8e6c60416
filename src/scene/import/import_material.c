// Clamps the values of imported materials to their ranges, finds and loads their images, and collects problems into one
// warning of each kind.
#include "scene/import/import_material.h"

#include "core/result.h"
#include "scene/import/model_files.h"
#include "scene/scene_build.h"

#include <stdio.h>
#include <string.h>

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

olx_result olx_import_texture_file(olx_material_import *import, const char *name, olx_texture_use use,
                                   uint32_t *number) {
  char path[8192];
  olx_model_file_locate(import->path, name, path, sizeof path);
  OLX_TRY(olx_model_file_check(import->scene, import->path, path));
  return olx_texture_table_request(&import->textures, path, NULL, 0, use, number);
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

void olx_import_repair_material(olx_material_import *import, olx_material *m, bool repaired) {
  repaired |= repair_color(&m->base_color, 1.0f, 0.8f);
  repaired |= repair_color(&m->emission, OLX_MOST_EMISSION, 0.0f);
  repaired |= repair_number(&m->metallic, 0.0f, 1.0f, 0.0f);
  repaired |= repair_number(&m->roughness, 0.0f, 1.0f, 1.0f);
  repaired |= repair_number(&m->alpha, 0.0f, 1.0f, 1.0f);
  repaired |= repair_number(&m->alpha_cutoff, 0.0f, 1e20f, 0.5f);
  repaired |= repair_number(&m->normal_scale, -1e4f, 1e4f, 1.0f);
  if (repaired) olx_name_list_add(&import->repaired, m->name);
  // With a texture, the product is clamped when it is sampled.
  if (m->base_color_texture == OLX_NO_TEXTURE && olx_max3(m->base_color) > OLX_MOST_ALBEDO) {
    m->base_color = olx_min_each(m->base_color, olx_splat(OLX_MOST_ALBEDO));
    olx_name_list_add(&import->clamped, m->name);
  }
}

void olx_import_blend(olx_material_import *import, olx_material *material) {
  material->blended = true;
  material->alpha_cutoff = 0.5f;
  olx_name_list_add(&import->blended, material->name);
}

static void resolve_textures(const olx_texture_table *textures, olx_material *m) {
  m->base_color_texture = olx_texture_table_resolve(textures, m->base_color_texture);
  m->alpha_texture = olx_texture_table_resolve(textures, m->alpha_texture);
  m->metallic_roughness_texture = olx_texture_table_resolve(textures, m->metallic_roughness_texture);
  m->emission_texture = olx_texture_table_resolve(textures, m->emission_texture);
  m->normal_texture = olx_texture_table_resolve(textures, m->normal_texture);
}

olx_result olx_import_load_textures(olx_material_import *import, uint32_t first) {
  OLX_TRY(olx_texture_table_load(&import->textures, import->path, import->scene));
  for (uint32_t i = first; i < import->scene->material_count; ++i) {
    resolve_textures(&import->textures, &import->scene->materials[i]);
  }
  return OLX_OK;
}

void olx_import_warn_about_materials(const olx_material_import *import) {
  const struct {
    const olx_name_list *list;
    const char *what;
  } kinds[] = {
      {&import->clamped, "an albedo above 0.95, clamped"},
      {&import->repaired, "numbers outside their range, clamped"},
      {&import->blended, "partial opacity: light passes in part, and probes see it where alpha is 0.5 or more"},
      {&import->glazed,
       "transmission beside emission, a mask or a texture of it: it is left out, and lets no light pass"},
      {&import->tinted, "a specular colour: its luminance, up to 1, scales reflections at all angles"},
      {&import->displaced, "specular textures with other coordinates than the roughness texture: they are left out"},
      {&import->crowded, "textures with more than two kinds of coordinates: the others use the first one's"},
  };
  for (size_t i = 0; i < sizeof kinds / sizeof *kinds; ++i) {
    if (!kinds[i].list->count) continue;
    olx_scene_warn(import->scene, "%s: %u material%s %s (%s)", import->path, kinds[i].list->count,
                   kinds[i].list->count == 1 ? " has" : "s have", kinds[i].what, kinds[i].list->names);
  }
}
