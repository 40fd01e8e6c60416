// Converts KHR_materials_pbrSpecularGlossiness to the metallic-roughness model: factors as numbers, textures texel by
// texel.
#include "scene/gltf/gltf_glossiness.h"

#include "core/hooks.h"
#include "core/result.h"
#include "scene/gltf/gltf_specular.h"
#include "scene/import/import_limits.h"
#include "scene/scene_build.h"
#include "scene/texture.h"

#define DIELECTRIC 0.04f // F0 of the specular weight 1

// Returns the dielectric's share x of a mix whose diffuse reflectance is d and whose F0 is s, with s at least that of a
// dielectric: of base colour b it has d = b x and s = 0.04 x + b (1 - x).
static float dielectric_share(float d, float s) {
  const float sum = d + s;
  return 2.0f * d / (sum + sqrtf(olx_max(sum * sum - 4.0f * DIELECTRIC * d, 0.0f)));
}

static olx_vec3 clamp_color(olx_vec3 c) { return olx_min_each(olx_max_each(c, olx_splat(0.0f)), olx_splat(1.0f)); }

olx_gltf_converted olx_gltf_convert_glossiness(const olx_gltf_glossiness *surface) {
  const olx_vec3 specular = clamp_color(surface->specular);
  const float most = olx_max3(specular);
  const olx_vec3 reflected = olx_scale(clamp_color(surface->diffuse), 1.0f - most); // by the extension's diffuse lobe
  const float roughness = 1.0f - olx_clamp(surface->glossiness, 0.0f, 1.0f);
  if (most <= DIELECTRIC) {
    const float weight = olx_luminance(specular) / DIELECTRIC;
    const olx_vec3 base = olx_scale(reflected, 1.0f / (1.0f - DIELECTRIC * weight));
    return (olx_gltf_converted){clamp_color(base), 0.0f, roughness, weight};
  }
  const olx_vec3 diffuse = olx_scale(reflected, 1.0f / (1.0f - DIELECTRIC));
  const float x = dielectric_share(olx_luminance(diffuse), olx_max(olx_luminance(specular), DIELECTRIC));
  const float metallic = 1.0f - x;
  const olx_vec3 of_metal = olx_scale(olx_sub(specular, olx_splat(DIELECTRIC * x)), 1.0f / olx_max(metallic, 1e-6f));
  const olx_vec3 of_dielectric = olx_scale(diffuse, 1.0f / olx_max(x, 1e-6f));
  // Both have the same luminance. The nearer the surface is to a metal, the more the colour of its reflections counts.
  const olx_vec3 base = olx_mix3(clamp_color(of_dielectric), clamp_color(of_metal), metallic * metallic);
  return (olx_gltf_converted){base, metallic, roughness, 1.0f};
}

static const olx_texture *image_of(const olx_texture_table *table, uint32_t number) {
  return number != OLX_NO_TEXTURE && table->requests[number].texture.texels ? &table->requests[number].texture : NULL;
}

static olx_texel sample(const olx_texture *image, olx_vec2 uv) {
  return image ? olx_texture_sample(image, uv) : (olx_texel){olx_splat(1.0f), 1.0f};
}

static uint8_t byte_of(float share) { return (uint8_t)lrintf(255.0f * share); }

static uint8_t encode_srgb(float linear) {
  return byte_of(linear <= 0.0031308f ? 12.92f * linear : 1.055f * powf(linear, 1.0f / 2.4f) - 0.055f);
}

static void convert_texels(const olx_gltf_glossy_images *images, const olx_texture *diffuse,
                           const olx_texture *specular, const olx_texture *colors, const olx_texture *surfaces) {
  for (uint32_t i = 0; i < colors->width * colors->height; ++i) {
    const olx_vec2 uv = {((float)(i % colors->width) + 0.5f) / (float)colors->width,
                         ((float)(i / colors->width) + 0.5f) / (float)colors->height};
    const olx_texel d = sample(diffuse, uv), s = sample(specular, uv);
    const olx_gltf_glossiness product = {olx_mul(images->factors.diffuse, d.color),
                                         olx_mul(images->factors.specular, s.color),
                                         images->factors.glossiness * s.alpha};
    const olx_gltf_converted c = olx_gltf_convert_glossiness(&product);
    const uint8_t color[4] = {encode_srgb(c.base_color.x), encode_srgb(c.base_color.y), encode_srgb(c.base_color.z),
                              byte_of(d.alpha)};
    const uint8_t surface[4] = {255, byte_of(c.roughness), byte_of(c.metallic),
                                byte_of(olx_min(c.specular_weight, 1.0f))};
    for (int k = 0; k < 4; ++k) {
      colors->texels[4 * (size_t)i + (size_t)k] = color[k];
      surfaces->texels[4 * (size_t)i + (size_t)k] = surface[k];
    }
  }
}

static olx_result allocate_texels(olx_texture *texture) {
  texture->texels = olx_allocate((size_t)texture->width * texture->height, 4);
  return texture->texels ? OLX_OK : olx_fail(OLX_ERROR_MEMORY, "out of memory for a texture");
}

// Gives both textures to the scene, which owns them from here on, even where it fails.
static olx_result add_textures(olx_scene *scene, olx_material *material, const olx_texture *colors,
                               const olx_texture *surfaces) {
  const olx_result added = olx_scene_add_texture(scene, colors, &material->base_color_texture);
  if (added != OLX_OK) {
    olx_release(surfaces->texels);
    return added;
  }
  return olx_scene_add_texture(scene, surfaces, &material->metallic_roughness_texture);
}

olx_result olx_gltf_merge_glossiness(const olx_gltf_glossy_images *images, const olx_texture_table *table,
                                     const char *path, const char *element, olx_scene *scene, olx_material *material) {
  const olx_texture *diffuse = image_of(table, images->diffuse), *specular = image_of(table, images->specular);
  olx_texture colors = {.srgb = true}, surfaces = {0};
  if (!diffuse && !specular) return OLX_OK;
  for (int i = 0; i < 2; ++i) {
    const olx_texture *image = i ? specular : diffuse;
    if (image && image->width > colors.width) colors.width = surfaces.width = image->width;
    if (image && image->height > colors.height) colors.height = surfaces.height = image->height;
  }
  const uint64_t texels = 2 * (uint64_t)colors.width * colors.height;
  OLX_TRY(olx_import_check_limit(scene, OLX_LIMIT_TEXELS, olx_scene_texels(scene) + texels, path, element));
  OLX_TRY(allocate_texels(&colors));
  const olx_result allocated = allocate_texels(&surfaces);
  if (allocated != OLX_OK) {
    olx_release(colors.texels);
    return allocated;
  }
  convert_texels(images, diffuse, specular, &colors, &surfaces);
  material->base_color = olx_splat(1.0f);
  material->metallic = material->roughness = material->specular_weight = 1.0f;
  material->specular_in_alpha = true;
  return add_textures(scene, material, &colors, &surfaces);
}
