// Converts KHR_materials_transmission to opacity: of factors as a number, of textures texel by texel.
#include "scene/gltf/gltf_transmission.h"

#include "core/hooks.h"
#include "core/result.h"
#include "scene/import/import_limits.h"
#include "scene/scene_build.h"
#include "scene/texture.h"

#include <string.h>

static bool has_slot(const olx_material *m, olx_texture_slot slot) { return (m->second_uvs & slot) != 0; }

void olx_gltf_find_glass(const olx_material *material, olx_gltf_glass *glass) {
  const bool colored = material->base_color_texture != OLX_NO_TEXTURE;
  const bool together = has_slot(material, OLX_SLOT_BASE_COLOR) == has_slot(material, OLX_SLOT_METALLIC_ROUGHNESS);
  if (colored) glass->color = material->base_color;
  glass->metallic = material->metallic;
  glass->images[OLX_GLASS_COLOR] = material->base_color_texture;
  glass->images[OLX_GLASS_METAL] = !colored || together ? material->metallic_roughness_texture : OLX_NO_TEXTURE;
}

static bool is_textured(const olx_gltf_glass *g) {
  return g->images[OLX_GLASS_COLOR] != OLX_NO_TEXTURE || g->images[OLX_GLASS_METAL] != OLX_NO_TEXTURE;
}

bool olx_gltf_same_glass(const olx_gltf_glass *a, const olx_gltf_glass *b) {
  return is_textured(a) && a->transmission == b->transmission && a->keeps_alpha == b->keeps_alpha &&
         a->color.x == b->color.x && a->color.y == b->color.y && a->color.z == b->color.z &&
         a->metallic == b->metallic && memcmp(a->images, b->images, sizeof a->images) == 0;
}

// Returns the opacity where the textures have these values.
static float opacity_of(const olx_gltf_glass *g, olx_vec3 color, float metallic) {
  const olx_vec3 c = olx_mul(g->color, color);
  const float tint = olx_clamp((c.x + c.y + c.z) * (1.0f / 3.0f), 0.0f, 1.0f);
  return 1.0f - g->transmission * (1.0f - g->metallic * metallic) * tint;
}

// Fills the texels of `made`: base colours as they are, opacity in alpha.
static void fill_texels(const olx_gltf_glass *g, const olx_texture *colors, const olx_texture *metal,
                        const olx_texture *made) {
  for (uint32_t i = 0; i < made->width * made->height; ++i) {
    const uint32_t x = i % made->width, y = i / made->width;
    const olx_vec2 uv = {((float)x + 0.5f) / (float)made->width, ((float)y + 0.5f) / (float)made->height};
    const olx_texel white = {olx_splat(1.0f), 1.0f};
    const olx_texel color = colors ? olx_texture_texel(colors, (int32_t)x, (int32_t)y) : white;
    const float opacity = opacity_of(g, color.color, metal ? olx_texture_sample(metal, uv).color.z : 1.0f);
    uint8_t *texel = made->texels + 4 * (size_t)i;
    if (colors) memcpy(texel, colors->texels + 4 * (size_t)i, 3);
    else memset(texel, 255, 3);
    texel[3] = (uint8_t)lrintf(255.0f * opacity * (g->keeps_alpha ? color.alpha : 1.0f));
  }
}

static const olx_texture *image_of(const olx_gltf_glass *g, const olx_scene *scene, uint32_t which) {
  return g->images[which] == OLX_NO_TEXTURE ? NULL : &scene->textures[g->images[which]];
}

// A texture of opacity lies as that of the base colours, or else as that of metalness.
static void place_opacity(const olx_gltf_glass *g, olx_material *material) {
  if (g->images[OLX_GLASS_COLOR] != OLX_NO_TEXTURE) return;
  if (has_slot(material, OLX_SLOT_METALLIC_ROUGHNESS)) material->second_uvs |= OLX_SLOT_BASE_COLOR;
  else material->second_uvs &= ~(uint32_t)OLX_SLOT_BASE_COLOR;
}

void olx_gltf_share_glass(const olx_gltf_glass *glass, const olx_material *made, olx_material *material) {
  place_opacity(glass, material);
  material->base_color_texture = made->base_color_texture;
}

olx_result olx_gltf_apply_glass(const olx_gltf_glass *glass, const char *path, const char *element, olx_scene *scene,
                                olx_material *material) {
  if (!is_textured(glass)) {
    material->alpha *= opacity_of(glass, olx_splat(1.0f), 1.0f);
    return OLX_OK;
  }
  const olx_texture *colors = image_of(glass, scene, OLX_GLASS_COLOR), *metal = image_of(glass, scene, OLX_GLASS_METAL);
  olx_texture made = colors ? *colors : *metal;
  made.srgb = colors && colors->srgb;
  const uint64_t texels = (uint64_t)made.width * made.height;
  OLX_TRY(olx_import_check_limit(scene, OLX_LIMIT_TEXELS, olx_scene_texels(scene) + texels, path, element));
  made.texels = olx_allocate(texels, 4);
  if (!made.texels) return olx_fail(OLX_ERROR_MEMORY, "out of memory for a texture");
  fill_texels(glass, colors, metal, &made);
  place_opacity(glass, material);
  return olx_scene_add_texture(scene, &made, &material->base_color_texture);
}
