// Maps KHR_materials_specular to specular weights: of factors as numbers, of textures texel by texel, merged with the
// texture of roughness and metallic.
#include "scene/gltf/gltf_specular.h"

#include "core/hooks.h"
#include "core/result.h"
#include "scene/import/import_limits.h"
#include "scene/scene_build.h"
#include "scene/texture.h"

float olx_gltf_specular_weight(float factor, olx_vec3 color) {
  const float most = 1.0f / 0.04f; // F0 is 1
  const olx_vec3 c = {olx_clamp(color.x, 0.0f, most), olx_clamp(color.y, 0.0f, most), olx_clamp(color.z, 0.0f, most)};
  return olx_min(factor * olx_luminance(c), 1.0f);
}

static const olx_texture *image_of(const olx_gltf_specular *s, const olx_texture_table *images, uint32_t which) {
  const uint32_t number = s->images[which];
  return number != OLX_NO_TEXTURE && images->requests[number].texture.texels ? &images->requests[number].texture : NULL;
}

static olx_texel sample(const olx_texture *image, olx_vec2 uv) {
  return image ? olx_texture_sample(image, uv) : (olx_texel){olx_splat(1.0f), 1.0f};
}

static uint8_t byte_of(float share) { return (uint8_t)lrintf(255.0f * share); }

static void merge_texels(const olx_gltf_specular *s, const olx_texture *const from[OLX_SPECULAR_IMAGES],
                         const olx_texture *to) {
  const float most = olx_gltf_specular_weight(s->factor, s->color);
  uint8_t *texel = to->texels;
  for (uint32_t i = 0; i < to->width * to->height; ++i, texel += 4) {
    const olx_vec2 uv = {((float)(i % to->width) + 0.5f) / (float)to->width,
                         ((float)(i / to->width) + 0.5f) / (float)to->height};
    const olx_vec3 surface = sample(from[OLX_SPECULAR_SURFACE], uv).color;
    const olx_vec3 tint = olx_mul(s->color, sample(from[OLX_SPECULAR_COLOR], uv).color);
    texel[0] = 255;
    texel[1] = byte_of(surface.y);
    texel[2] = byte_of(surface.z);
    const float weight = olx_gltf_specular_weight(s->factor * sample(from[OLX_SPECULAR_FACTOR], uv).alpha, tint);
    texel[3] = byte_of(weight < most ? weight / most : 1.0f);
  }
}

olx_result olx_gltf_merge_specular(const olx_gltf_specular *specular, const olx_texture_table *images, const char *path,
                                   const char *element, olx_scene *scene, olx_material *material) {
  const olx_texture *from[OLX_SPECULAR_IMAGES];
  olx_texture merged = {0};
  for (uint32_t i = 0; i < OLX_SPECULAR_IMAGES; ++i) {
    from[i] = image_of(specular, images, i);
    if (from[i] && from[i]->width > merged.width) merged.width = from[i]->width;
    if (from[i] && from[i]->height > merged.height) merged.height = from[i]->height;
  }
  if (!merged.width) return OLX_OK;
  const uint64_t texels = (uint64_t)merged.width * merged.height;
  OLX_TRY(olx_import_check_limit(scene, OLX_LIMIT_TEXELS, olx_scene_texels(scene) + texels, path, element));
  merged.texels = olx_allocate(texels, 4);
  if (!merged.texels) return olx_fail(OLX_ERROR_MEMORY, "out of memory for a texture");
  merge_texels(specular, from, &merged);
  material->specular_in_alpha = true;
  return olx_scene_add_texture(scene, &merged, &material->metallic_roughness_texture);
}
