// Writes a scene as a cooked file: arrays as in memory, materials and lights in the file's own form, textures
// compressed losslessly.
#include "core/hooks.h"
#include "core/parallel.h"
#include "core/result.h"
#include "scene/cooked/cooked_format.h"
#include "scene/cooked/texel_code.h"
#include "scene/sources.h"

#include <string.h>

void olx_cooked_shapes(const olx_cooked_info *info, olx_chunk_shape shapes[OLX_COOKED_CHUNKS]) {
  const uint64_t environment_texels = (uint64_t)info->environment_width * info->environment_height;
  const olx_chunk_row table[OLX_COOKED_CHUNKS] = {
      [OLX_COOKED_INFO] = {OLX_FOUR_CC('I', 'N', 'F', 'O'), sizeof(olx_cooked_info), 1, 1},
      [OLX_COOKED_POSITIONS] = {OLX_FOUR_CC('V', 'P', 'O', 'S'), 4, 3, info->vertices},
      [OLX_COOKED_NORMALS] = {OLX_FOUR_CC('V', 'N', 'O', 'R'), 4, 3, info->vertices},
      [OLX_COOKED_UVS] = {OLX_FOUR_CC('V', 'T', 'E', 'X'), 4, 2, info->vertices},
      [OLX_COOKED_TRIANGLES] = {OLX_FOUR_CC('T', 'R', 'I', 'S'), 4, 3, info->triangles},
      [OLX_COOKED_TRIANGLE_MATERIALS] = {OLX_FOUR_CC('T', 'M', 'A', 'T'), 4, 1, info->triangles},
      [OLX_COOKED_MATERIALS] = {OLX_FOUR_CC('M', 'A', 'T', 'S'), sizeof(olx_cooked_material), 1, info->materials},
      [OLX_COOKED_TEXTURES] = {OLX_FOUR_CC('T', 'E', 'X', 'S'), sizeof(olx_cooked_texture), 1, info->textures},
      [OLX_COOKED_TEXELS] = {OLX_FOUR_CC('T', 'X', 'L', 'S'), 1, 1, info->texel_code_bytes},
      [OLX_COOKED_LIGHTS] = {OLX_FOUR_CC('L', 'I', 'T', 'S'), sizeof(olx_cooked_light), 1, info->lights},
      [OLX_COOKED_CAMERAS] = {OLX_FOUR_CC('C', 'A', 'M', 'S'), sizeof(olx_cooked_camera), 1, info->cameras},
      [OLX_COOKED_ENVIRONMENT] = {OLX_FOUR_CC('E', 'N', 'V', 'I'), 4, 3, environment_texels},
      [OLX_COOKED_PINNED] = {OLX_FOUR_CC('P', 'I', 'N', 'S'), 4, 3, info->pinned},
      [OLX_COOKED_FORBIDDEN] = {OLX_FOUR_CC('F', 'B', 'O', 'X'), 4, 6, info->forbidden},
      [OLX_COOKED_WARNINGS] = {OLX_FOUR_CC('W', 'A', 'R', 'N'), 1, 1, info->warning_bytes},
      [OLX_COOKED_ORIGIN] = OLX_CHUNK_ORIGIN_ROW,
      [OLX_COOKED_SECOND_UVS_CHUNK] = {OLX_FOUR_CC('V', 'T', 'X', '2'), 4, 2, info->vertices},
      [OLX_COOKED_COLORS] = {OLX_FOUR_CC('V', 'C', 'O', 'L'), 4, 4, info->vertices},
      [OLX_COOKED_TANGENTS] = {OLX_FOUR_CC('V', 'T', 'A', 'N'), 4, 4, info->vertices},
  };
  for (uint32_t i = 0; i < OLX_COOKED_CHUNKS; i++) shapes[i] = olx_chunk_shape_of(&table[i]);
}

static olx_cooked_material store_material(const olx_material *m) {
  olx_cooked_material stored = {
      .metallic = m->metallic,
      .roughness = m->roughness,
      .specular_weight = m->specular_weight,
      .alpha = m->alpha,
      .alpha_cutoff = m->alpha_cutoff,
      .normal_scale = m->normal_scale,
      .base_color_texture = m->base_color_texture,
      .alpha_texture = m->alpha_texture,
      .metallic_roughness_texture = m->metallic_roughness_texture,
      .emission_texture = m->emission_texture,
      .normal_texture = m->normal_texture,
      .flags = (m->emits_both_sides ? OLX_COOKED_EMITS_BOTH_SIDES : 0u) |
               (m->normal_is_height ? OLX_COOKED_NORMAL_IS_HEIGHT : 0u) |
               (m->vertex_colors ? OLX_COOKED_VERTEX_COLORS : 0u) |
               (m->specular_in_alpha ? OLX_COOKED_SPECULAR_IN_ALPHA : 0u) | (m->blended ? OLX_COOKED_BLENDED : 0u) |
               m->second_uvs << OLX_COOKED_SECOND_UVS_SHIFT,
  };
  memcpy(stored.name, m->name, strlen(m->name));
  olx_store3(stored.base_color, m->base_color);
  olx_store3(stored.emission, m->emission);
  return stored;
}

static olx_cooked_light store_light(const olx_light *light) {
  olx_cooked_light stored = {
      .type = light->type, .cosine_inner = light->cosine_inner, .cosine_outer = light->cosine_outer};
  olx_store3(stored.position, light->position);
  olx_store3(stored.direction, light->direction);
  olx_store3(stored.emission, light->emission);
  return stored;
}

static olx_cooked_camera store_camera(const olx_camera *camera) {
  olx_cooked_camera stored = {.fov_y_degrees = camera->fov_y_degrees};
  memcpy(stored.name, camera->name, strlen(camera->name));
  olx_store3(stored.eye, camera->eye);
  olx_store3(stored.target, camera->target);
  olx_store3(stored.up, camera->up);
  return stored;
}

static olx_cooked_info store_info(const olx_scene *scene) {
  const olx_environment *e = &scene->environment;
  const olx_probe_rules *rules = &scene->probe_rules;
  olx_cooked_info info = {
      .vertices = scene->vertex_count,
      .triangles = scene->triangle_count,
      .materials = scene->material_count,
      .textures = scene->texture_count,
      .lights = scene->light_count,
      .cameras = scene->camera_count,
      .environment_width = e->texels ? e->width : 0,
      .environment_height = e->texels ? e->height : 0,
      .environment_rotation_radians = e->rotation_radians,
      .pinned = rules->pinned_count,
      .forbidden = rules->forbidden_count,
      .probe_flags = (scene->has_probe_volume ? OLX_COOKED_PROBE_VOLUME : 0u) |
                     (scene->has_probe_count ? OLX_COOKED_PROBE_COUNT : 0u) |
                     (rules->has_playable ? OLX_COOKED_PLAYABLE : 0u),
      .probes_count = {scene->probes_count[0], scene->probes_count[1], scene->probes_count[2]},
      .min_distance = rules->min_distance,
      .warning_count = scene->warning_count,
  };
  olx_store3(info.environment_radiance, e->radiance);
  olx_store3(info.probes_min, scene->probes_min);
  olx_store3(info.probes_max, scene->probes_max);
  olx_store3(info.playable_min, rules->playable.min);
  olx_store3(info.playable_max, rules->playable.max);
  return info;
}

// The data that is converted before it is written; the rest is written as it is in the scene.
typedef struct stored_scene {
  olx_cooked_info info;
  olx_cooked_material *materials;
  olx_cooked_texture *textures;
  olx_cooked_light *lights;
  olx_cooked_camera *cameras;
  olx_byte_buffer texels;
  char *warnings;
} stored_scene;

static void release_stored(stored_scene *s) {
  olx_release(s->materials);
  olx_release(s->textures);
  olx_release(s->lights);
  olx_release(s->cameras);
  olx_release(s->texels.data);
  olx_release(s->warnings);
}

static olx_result no_memory(void) { return olx_fail(OLX_ERROR_MEMORY, "out of memory"); }

static olx_result store_textures(const olx_scene *scene, stored_scene *s) {
  s->textures = olx_allocate(scene->texture_count, sizeof *s->textures);
  if (!s->textures) return no_memory();
  for (uint32_t i = 0; i < scene->texture_count; i++) {
    const olx_texture *t = &scene->textures[i];
    const uint32_t channels = olx_texel_channels(t);
    const size_t before = s->texels.size_bytes;
    OLX_TRY(olx_check_cancelled());
    if (!olx_texel_encode(t, channels, &s->texels)) return no_memory();
    s->textures[i] = (olx_cooked_texture){.width = t->width,
                                          .height = t->height,
                                          .channels = channels,
                                          .flags = t->srgb ? OLX_COOKED_SRGB : 0,
                                          .code_bytes = s->texels.size_bytes - before};
  }
  s->info.texel_code_bytes = s->texels.size_bytes;
  return OLX_OK;
}

static olx_result store_warnings(const olx_scene *scene, stored_scene *s) {
  for (uint32_t i = 0; i < scene->warning_count; i++) s->info.warning_bytes += strlen(scene->warnings[i]) + 1;
  s->warnings = olx_allocate(s->info.warning_bytes, 1);
  if (!s->warnings) return no_memory();
  char *at = s->warnings;
  for (uint32_t i = 0; i < scene->warning_count; i++) {
    const size_t size_bytes = strlen(scene->warnings[i]) + 1;
    memcpy(at, scene->warnings[i], size_bytes);
    at += size_bytes;
  }
  return OLX_OK;
}

static olx_result store_scene(const olx_scene *scene, stored_scene *s) {
  s->info = store_info(scene);
  s->materials = olx_allocate(scene->material_count, sizeof *s->materials);
  s->lights = olx_allocate(scene->light_count, sizeof *s->lights);
  s->cameras = olx_allocate(scene->camera_count, sizeof *s->cameras);
  if (!s->materials || !s->lights || !s->cameras) return no_memory();
  for (uint32_t i = 0; i < scene->material_count; i++) s->materials[i] = store_material(&scene->materials[i]);
  for (uint32_t i = 0; i < scene->light_count; i++) s->lights[i] = store_light(&scene->lights[i]);
  for (uint32_t i = 0; i < scene->camera_count; i++) s->cameras[i] = store_camera(&scene->cameras[i]);
  OLX_TRY(store_textures(scene, s));
  return store_warnings(scene, s);
}

// Moves the chunks that are present to the front; returns their number.
static uint32_t keep_present(olx_chunk_shape shapes[OLX_COOKED_CHUNKS], const void *data[OLX_COOKED_CHUNKS]) {
  uint32_t count = OLX_COOKED_REQUIRED;
  for (uint32_t i = OLX_COOKED_REQUIRED; i < OLX_COOKED_CHUNKS; i++) {
    if (!data[i]) continue;
    shapes[count] = shapes[i];
    data[count++] = data[i];
  }
  return count;
}

olx_result olx_scene_cook(const olx_scene *scene, const char *path, uint64_t *file_bytes) {
  stored_scene s = {0};
  OLX_TRY(olx_scene_check_output(scene, path));
  const olx_result stored = store_scene(scene, &s);
  if (stored != OLX_OK) {
    release_stored(&s);
    return olx_fail(stored, "%s: %s", path, olx_last_error());
  }
  const void *data[OLX_COOKED_CHUNKS] = {
      [OLX_COOKED_INFO] = &s.info,
      [OLX_COOKED_POSITIONS] = scene->positions,
      [OLX_COOKED_NORMALS] = scene->normals,
      [OLX_COOKED_UVS] = scene->uvs,
      [OLX_COOKED_TRIANGLES] = scene->indices,
      [OLX_COOKED_TRIANGLE_MATERIALS] = scene->material_index,
      [OLX_COOKED_MATERIALS] = s.materials,
      [OLX_COOKED_TEXTURES] = s.textures,
      [OLX_COOKED_TEXELS] = s.texels.data,
      [OLX_COOKED_LIGHTS] = s.lights,
      [OLX_COOKED_CAMERAS] = s.cameras,
      [OLX_COOKED_ENVIRONMENT] = scene->environment.texels,
      [OLX_COOKED_PINNED] = scene->probe_rules.pinned,
      [OLX_COOKED_FORBIDDEN] = scene->probe_rules.forbidden,
      [OLX_COOKED_WARNINGS] = s.warnings,
      [OLX_COOKED_ORIGIN] = olx_origin_is_stored(scene->origin) ? scene->origin : NULL,
      [OLX_COOKED_SECOND_UVS_CHUNK] = scene->second_uvs,
      [OLX_COOKED_COLORS] = scene->colors,
      [OLX_COOKED_TANGENTS] = scene->tangents,
  };
  olx_chunk_shape shapes[OLX_COOKED_CHUNKS];
  olx_cooked_shapes(&s.info, shapes);
  const uint32_t count = keep_present(shapes, data);
  const olx_result result = olx_chunk_file_write(path, &OLX_COOKED_KIND, shapes, data, count, file_bytes);
  release_stored(&s);
  return result;
}
