// Hashes a scene, and the parts of it on which the stages of a bake depend.
#include "scene/scene_parts.h"

#include "core/hooks.h"
#include "core/result.h"
#include "scene/local_frame.h"

#include <string.h>

#define XXH_INLINE_ALL
#include <xxhash.h>

static void hash_material(XXH3_state_t *state, const olx_material *m) {
  const float numbers[] = {m->base_color.x, m->base_color.y, m->base_color.z, m->metallic,
                           m->roughness,    m->emission.x,   m->emission.y,   m->emission.z,
                           m->alpha,        m->alpha_cutoff, m->normal_scale, m->specular_weight};
  const uint32_t words[] = {m->base_color_texture,
                            m->alpha_texture,
                            m->metallic_roughness_texture,
                            m->emission_texture,
                            m->normal_texture,
                            (m->emits_both_sides ? 1u : 0u) | (m->normal_is_height ? 2u : 0u) |
                                (m->vertex_colors ? 4u : 0u) | (m->specular_in_alpha ? 8u : 0u) |
                                (m->blended ? 16u : 0u) | m->second_uvs << 8};
  XXH3_64bits_update(state, numbers, sizeof numbers);
  XXH3_64bits_update(state, words, sizeof words);
}

static void hash_light(XXH3_state_t *state, const olx_light *l) {
  const float numbers[] = {l->position.x, l->position.y, l->position.z, l->direction.x,  l->direction.y, l->direction.z,
                           l->emission.x, l->emission.y, l->emission.z, l->cosine_inner, l->cosine_outer};
  const uint32_t type = l->type;
  XXH3_64bits_update(state, &type, sizeof type);
  XXH3_64bits_update(state, numbers, sizeof numbers);
}

static void hash_environment(XXH3_state_t *state, const olx_environment *e) {
  const float numbers[] = {e->radiance.x, e->radiance.y, e->radiance.z, e->rotation_radians};
  XXH3_64bits_update(state, numbers, sizeof numbers);
  XXH3_64bits_update(state, &e->width, sizeof e->width);
  XXH3_64bits_update(state, &e->height, sizeof e->height);
  if (e->texels) XXH3_64bits_update(state, e->texels, (size_t)e->width * e->height * 3 * sizeof(float));
}

// Hashes attributes that few scenes have.
static void hash_rare(XXH3_state_t *state, const olx_scene *scene) {
  const size_t count = scene->vertex_count;
  if (scene->second_uvs) XXH3_64bits_update(state, scene->second_uvs, count * sizeof *scene->second_uvs);
  if (scene->colors) XXH3_64bits_update(state, scene->colors, count * sizeof *scene->colors);
  if (scene->tangents) XXH3_64bits_update(state, scene->tangents, count * sizeof *scene->tangents);
}

static void hash_texture(XXH3_state_t *state, const olx_texture *texture) {
  const uint32_t words[] = {texture->width, texture->height, texture->srgb ? 1u : 0u};
  XXH3_64bits_update(state, words, sizeof words);
  XXH3_64bits_update(state, texture->texels, (size_t)texture->width * texture->height * 4);
}

uint64_t olx_scene_hash(const olx_scene *scene) {
  XXH3_state_t state;
  XXH3_64bits_reset(&state);
  const uint32_t counts[] = {scene->vertex_count, scene->triangle_count, scene->material_count, scene->texture_count,
                             scene->light_count};
  XXH3_64bits_update(&state, counts, sizeof counts);
  XXH3_64bits_update(&state, scene->positions, scene->vertex_count * sizeof *scene->positions);
  XXH3_64bits_update(&state, scene->normals, scene->vertex_count * sizeof *scene->normals);
  XXH3_64bits_update(&state, scene->uvs, scene->vertex_count * sizeof *scene->uvs);
  hash_rare(&state, scene);
  XXH3_64bits_update(&state, scene->indices, (size_t)scene->triangle_count * 3 * sizeof *scene->indices);
  XXH3_64bits_update(&state, scene->material_index, scene->triangle_count * sizeof *scene->material_index);
  for (uint32_t i = 0; i < scene->material_count; ++i) hash_material(&state, &scene->materials[i]);
  for (uint32_t i = 0; i < scene->texture_count; ++i) hash_texture(&state, &scene->textures[i]);
  for (uint32_t i = 0; i < scene->light_count; ++i) hash_light(&state, &scene->lights[i]);
  if (olx_scene_is_far(scene)) XXH3_64bits_update(&state, scene->origin, sizeof scene->origin);
  hash_environment(&state, &scene->environment);
  return XXH3_64bits_digest(&state);
}

// ---- Parts

static bool is_masked(const olx_scene *scene, uint32_t triangle) {
  return scene->materials[scene->material_index[triangle]].alpha_cutoff > 0.0f;
}

// Hashes what decides where the triangles of a masked material are present.
static void hash_mask(XXH3_state_t *state, const olx_scene *scene, const olx_material *m) {
  const float numbers[] = {m->alpha, m->alpha_cutoff};
  const uint32_t words[] = {m->base_color_texture, m->alpha_texture, m->second_uvs | (m->blended ? 1u << 8 : 0u)};
  XXH3_64bits_update(state, numbers, sizeof numbers);
  XXH3_64bits_update(state, words, sizeof words);
  if (m->base_color_texture != OLX_NO_TEXTURE) hash_texture(state, &scene->textures[m->base_color_texture]);
  if (m->alpha_texture != OLX_NO_TEXTURE) hash_texture(state, &scene->textures[m->alpha_texture]);
}

// Hashes everything that decides where alpha masks let rays through: the materials that have masks, the triangles
// that these materials are on, and the texture coordinates there.
static void hash_masks(XXH3_state_t *state, const olx_scene *scene) {
  bool any = false;
  for (uint32_t i = 0; i < scene->material_count; i++) {
    if (!(scene->materials[i].alpha_cutoff > 0.0f)) continue;
    XXH3_64bits_update(state, &i, sizeof i);
    hash_mask(state, scene, &scene->materials[i]);
  }
  for (uint32_t t = 0; t < scene->triangle_count; t++) {
    if (!is_masked(scene, t)) continue;
    const uint32_t words[] = {t, scene->material_index[t]};
    XXH3_64bits_update(state, words, sizeof words);
    any = true;
  }
  if (!any) return;
  XXH3_64bits_update(state, scene->uvs, scene->vertex_count * sizeof *scene->uvs);
  hash_rare(state, scene);
}

static uint64_t hash_geometry(const olx_scene *scene) {
  XXH3_state_t state;
  XXH3_64bits_reset(&state);
  XXH3_64bits_update(&state, scene->positions, scene->vertex_count * sizeof *scene->positions);
  XXH3_64bits_update(&state, scene->normals, scene->vertex_count * sizeof *scene->normals);
  XXH3_64bits_update(&state, scene->indices, (size_t)scene->triangle_count * 3 * sizeof *scene->indices);
  XXH3_64bits_update(&state, scene->origin, sizeof scene->origin);
  hash_masks(&state, scene);
  return XXH3_64bits_digest(&state);
}

static uint64_t hash_materials(const olx_scene *scene) {
  XXH3_state_t state;
  XXH3_64bits_reset(&state);
  XXH3_64bits_update(&state, scene->uvs, scene->vertex_count * sizeof *scene->uvs);
  hash_rare(&state, scene);
  XXH3_64bits_update(&state, scene->material_index, scene->triangle_count * sizeof *scene->material_index);
  for (uint32_t i = 0; i < scene->material_count; i++) hash_material(&state, &scene->materials[i]);
  for (uint32_t i = 0; i < scene->texture_count; i++) hash_texture(&state, &scene->textures[i]);
  return XXH3_64bits_digest(&state);
}

static uint64_t hash_lights(const olx_scene *scene) {
  XXH3_state_t state;
  XXH3_64bits_reset(&state);
  for (uint32_t i = 0; i < scene->light_count; i++) hash_light(&state, &scene->lights[i]);
  hash_environment(&state, &scene->environment);
  return XXH3_64bits_digest(&state);
}

olx_scene_parts_hash olx_scene_hash_parts(const olx_scene *scene) {
  return (olx_scene_parts_hash){hash_geometry(scene), hash_materials(scene), hash_lights(scene)};
}

// ---- Inputs of rays

static void hash_textures_of(XXH3_state_t *state, const olx_scene *scene, const olx_material *m) {
  const uint32_t textures[] = {m->base_color_texture, m->alpha_texture, m->metallic_roughness_texture,
                               m->emission_texture, m->normal_texture};
  for (uint32_t i = 0; i < sizeof textures / sizeof *textures; i++) {
    if (textures[i] != OLX_NO_TEXTURE) hash_texture(state, &scene->textures[textures[i]]);
  }
}

static uint64_t hash_surfaces(const olx_scene *scene) {
  XXH3_state_t state;
  XXH3_64bits_reset(&state);
  const uint64_t geometry = hash_geometry(scene);
  XXH3_64bits_update(&state, &geometry, sizeof geometry);
  XXH3_64bits_update(&state, scene->uvs, scene->vertex_count * sizeof *scene->uvs);
  hash_rare(&state, scene);
  XXH3_64bits_update(&state, scene->material_index, scene->triangle_count * sizeof *scene->material_index);
  return XXH3_64bits_digest(&state);
}

// Returns a hash of what decides where triangles of a material are present; 0 for a material without a mask.
static uint64_t hash_mask_of(const olx_scene *scene, uint32_t material) {
  XXH3_state_t state;
  if (!(scene->materials[material].alpha_cutoff > 0.0f)) return 0;
  XXH3_64bits_reset(&state);
  hash_mask(&state, scene, &scene->materials[material]);
  return XXH3_64bits_digest(&state);
}

// Returns the hash of all data of a triangle, with its number and that of its material, but not the material itself.
static uint64_t hash_triangle(const olx_scene *scene, uint32_t triangle) {
  XXH3_state_t state;
  XXH3_64bits_reset(&state);
  const uint32_t words[] = {triangle, scene->material_index[triangle]};
  XXH3_64bits_update(&state, words, sizeof words);
  for (uint32_t i = 0; i < 3; i++) {
    const uint32_t v = scene->indices[3 * (size_t)triangle + i];
    XXH3_64bits_update(&state, &scene->positions[v], sizeof scene->positions[v]);
    XXH3_64bits_update(&state, &scene->normals[v], sizeof scene->normals[v]);
    XXH3_64bits_update(&state, &scene->uvs[v], sizeof scene->uvs[v]);
    if (scene->second_uvs) XXH3_64bits_update(&state, &scene->second_uvs[v], sizeof scene->second_uvs[v]);
    if (scene->colors) XXH3_64bits_update(&state, &scene->colors[v], sizeof scene->colors[v]);
    if (scene->tangents) XXH3_64bits_update(&state, &scene->tangents[v], sizeof scene->tangents[v]);
  }
  return XXH3_64bits_digest(&state);
}

static uint64_t hash_emitters(const olx_scene *scene) {
  XXH3_state_t state;
  XXH3_64bits_reset(&state);
  const uint64_t lights = hash_lights(scene);
  XXH3_64bits_update(&state, &lights, sizeof lights);
  for (uint32_t i = 0; i < scene->material_count; i++) {
    const olx_material *m = &scene->materials[i];
    if (olx_max3(m->emission) <= 0.0f) continue;
    XXH3_64bits_update(&state, &i, sizeof i);
    hash_material(&state, m);
    hash_textures_of(&state, scene, m);
  }
  for (uint32_t t = 0; t < scene->triangle_count; t++) {
    if (olx_max3(scene->materials[scene->material_index[t]].emission) <= 0.0f) continue;
    const uint64_t triangle = hash_triangle(scene, t);
    XXH3_64bits_update(&state, &triangle, sizeof triangle);
  }
  return XXH3_64bits_digest(&state);
}

static void add_triangle(const olx_space_bricks *b, const olx_scene *scene, uint32_t triangle, uint64_t mask,
                         uint64_t hashes[OLX_SPACE_BRICKS]) {
  olx_vec3 low = olx_splat(INFINITY), high = olx_splat(-INFINITY);
  for (uint32_t i = 0; i < 3; i++) {
    const olx_vec3 p = scene->positions[scene->indices[3 * (size_t)triangle + i]];
    low = olx_min_each(low, p);
    high = olx_max_each(high, p);
  }
  const olx_brick_range near = olx_space_bricks_near(b, low, high);
  const uint64_t own = hash_triangle(scene, triangle);
  for (uint32_t z = near.first[2]; z <= near.last[2]; z++) {
    for (uint32_t y = near.first[1]; y <= near.last[1]; y++) {
      for (uint32_t x = near.first[0]; x <= near.last[0]; x++) {
        uint64_t *hash = &hashes[olx_space_brick(b, x, y, z)];
        const uint64_t all[] = {*hash, own, mask};
        *hash = XXH3_64bits(all, sizeof all);
      }
    }
  }
}

static olx_result hash_bricks(const olx_scene *scene, uint64_t hashes[OLX_SPACE_BRICKS]) {
  const olx_space_bricks bricks = olx_space_bricks_make(scene->bounds_min, scene->bounds_max);
  uint64_t *masks = olx_allocate((size_t)scene->material_count + 1, sizeof *masks);
  if (!masks) return olx_fail(OLX_ERROR_MEMORY, "scene: out of memory for %u materials", scene->material_count);
  for (uint32_t i = 0; i < scene->material_count; i++) masks[i] = hash_mask_of(scene, i);
  for (uint32_t t = 0; t < scene->triangle_count; t++) {
    add_triangle(&bricks, scene, t, masks[scene->material_index[t]], hashes);
  }
  olx_release(masks);
  return OLX_OK;
}

olx_result olx_scene_hash_inputs(const olx_scene *scene, olx_scene_inputs *inputs) {
  memset(inputs, 0, sizeof *inputs);
  inputs->surfaces = hash_surfaces(scene);
  inputs->low = scene->bounds_min;
  inputs->high = scene->bounds_max;
  for (uint32_t i = 0; i < 3; i++) inputs->origin[i] = scene->origin[i];
  for (uint32_t i = 0; i < scene->material_count; i++) {
    XXH3_state_t state;
    uint64_t *slot = &inputs->slots[i % OLX_INPUT_MATERIALS];
    XXH3_64bits_reset(&state);
    XXH3_64bits_update(&state, slot, sizeof *slot);
    hash_material(&state, &scene->materials[i]);
    hash_textures_of(&state, scene, &scene->materials[i]);
    *slot = XXH3_64bits_digest(&state);
  }
  inputs->slots[OLX_INPUT_LIGHTS] = hash_emitters(scene);
  return hash_bricks(scene, inputs->bricks);
}
