// Reads cooked scenes: validates each chunk before its use, then copies arrays and decodes textures in parallel.
#include "core/file.h"
#include "core/hooks.h"
#include "core/parallel.h"
#include "core/result.h"
#include "scene/cooked/cooked_format.h"
#include "scene/cooked/texel_code.h"
#include "scene/scene_build.h"

#include <string.h>

// A file being read: its chunks, whose checksums and sizes have been verified.
typedef struct cooked_file {
  const char *name;
  const olx_cooked_info *info;
  const void *data[OLX_COOKED_CHUNKS];
} cooked_file;

static bool within(float value, float low, float high) { return value >= low && value <= high; }

static bool is_light(olx_vec3 v) {
  return within(v.x, 0.0f, OLX_MOST_EMISSION) && within(v.y, 0.0f, OLX_MOST_EMISSION) &&
         within(v.z, 0.0f, OLX_MOST_EMISSION);
}

static bool is_unit(olx_vec3 n) { return fabsf(olx_dot(n, n) - 1.0f) < 2e-3f; }

static bool is_box(const olx_scene *scene, olx_vec3 low, olx_vec3 high) {
  return olx_scene_holds(scene, low) && olx_scene_holds(scene, high) && high.x >= low.x && high.y >= low.y &&
         high.z >= low.z;
}

// Returns whether a name is terminated within its bytes and padded with zeros.
static bool is_name(const char *name, size_t size_bytes) {
  const size_t length = strnlen(name, size_bytes);
  if (length == size_bytes) return false;
  for (size_t i = length; i < size_bytes; i++) {
    if (name[i]) return false;
  }
  return true;
}

static olx_result refuse(const cooked_file *file, const char *what, uint32_t index, const char *problem) {
  return olx_fail(OLX_ERROR_FORMAT, "%s: %s %u: %s", file->name, what, index, problem);
}

// ---- The description

static olx_result check_info(const cooked_file *file) {
  const olx_cooked_info *i = file->info;
  const char *problem = NULL;
  const bool image = i->environment_width || i->environment_height;
  if (i->triangles < 1 || i->triangles >= UINT32_MAX / 3) problem = "too few or too many triangles";
  else if (i->vertices < 3 || i->materials < 1) problem = "no vertices or no materials";
  else if (i->warning_bytes > OLX_COOKED_MAX_WARNING_BYTES) problem = "too many warnings";
  else if (image && (!within((float)i->environment_width, 1.0f, OLX_COOKED_MAX_TEXTURE_SIZE) ||
                     !within((float)i->environment_height, 1.0f, OLX_COOKED_MAX_TEXTURE_SIZE)))
    problem = "an environment of impossible size";
  else if (!is_light(olx_load3(i->environment_radiance)) || !isfinite(i->environment_rotation_radians))
    problem = "an impossible environment";
  else if (i->probe_flags & ~7u) problem = "unknown flags";
  else if (!within(i->min_distance, 0.0f, 1e9f)) problem = "an impossible distance between probes";
  for (uint32_t k = 0; k < 3 && !problem && (i->probe_flags & OLX_COOKED_PROBE_COUNT); k++) {
    if (i->probes_count[k] < 1 || i->probes_count[k] > 1024) problem = "an impossible count of probes";
  }
  return problem ? olx_fail(OLX_ERROR_FORMAT, "%s: chunk INFO: %s", file->name, problem) : OLX_OK;
}

static olx_result find_chunks(const olx_chunk_file *chunks, cooked_file *file) {
  olx_chunk_shape shapes[OLX_COOKED_CHUNKS];
  OLX_TRY(olx_chunk_file_check(chunks, &OLX_COOKED_KIND));
  const olx_file_header *header = chunks->data;
  for (uint32_t i = 0; i < header->chunk_count; i++) OLX_TRY(olx_chunk_check_content(chunks, i));
  olx_cooked_shapes(&(olx_cooked_info){0}, shapes);
  OLX_TRY(olx_chunk_find_shaped(chunks, &shapes[OLX_COOKED_INFO], &file->data[OLX_COOKED_INFO]));
  file->info = file->data[OLX_COOKED_INFO];
  OLX_TRY(check_info(file));
  olx_cooked_shapes(file->info, shapes);
  for (uint32_t k = 1; k < OLX_COOKED_CHUNKS; k++) {
    const olx_file_chunk *chunk = NULL;
    if (k >= OLX_COOKED_REQUIRED) OLX_TRY(olx_chunk_find_any(chunks, shapes[k].type, &chunk));
    if (k < OLX_COOKED_REQUIRED || chunk) OLX_TRY(olx_chunk_find_shaped(chunks, &shapes[k], &file->data[k]));
  }
  return olx_chunk_refuse_unknown(chunks, shapes, OLX_COOKED_CHUNKS);
}

// ---- The parts of a scene, each validated and copied

// Copies `count` elements to an array with the capacity that appending to a scene expects.
static olx_result copy_array(const cooked_file *file, olx_cooked_chunk chunk, uint32_t count, size_t element_bytes,
                             void **copy) {
  *copy = olx_scene_array(count, element_bytes);
  if (!*copy) return olx_fail(OLX_ERROR_MEMORY, "%s: out of memory", file->name);
  memcpy(*copy, file->data[chunk], (size_t)count * element_bytes);
  return OLX_OK;
}

#define COPY_ARRAY(file, chunk, count, array)                                                                          \
  do {                                                                                                                 \
    void *copy_;                                                                                                       \
    OLX_TRY(copy_array((file), (chunk), (count), sizeof *(array), &copy_));                                            \
    (array) = copy_;                                                                                                   \
  } while (0)

static bool is_tangent(olx_vec4 t) {
  const bool none = t.x == 0.0f && t.y == 0.0f && t.z == 0.0f && t.w == 0.0f;
  return none || (is_unit(olx_v3(t.x, t.y, t.z)) && fabsf(t.w) == 1.0f);
}

static bool is_color(olx_vec4 c) {
  return within(c.x, 0.0f, 1.0f) && within(c.y, 0.0f, 1.0f) && within(c.z, 0.0f, 1.0f) && within(c.w, 0.0f, 1.0f);
}

static const char *find_rare_problem(const olx_scene *scene, uint32_t v) {
  const olx_vec2 *uvs = scene->second_uvs;
  if (uvs && (!isfinite(uvs[v].x) || !isfinite(uvs[v].y))) return "a second texture coordinate that is not finite";
  if (scene->colors && !is_color(scene->colors[v])) return "a colour that is not within 0 to 1";
  if (scene->tangents && !is_tangent(scene->tangents[v])) return "a tangent that is not unit, or without a side";
  return NULL;
}

// Reads the attributes that few scenes have.
static olx_result read_rare(const cooked_file *file, olx_scene *scene) {
  const uint32_t vertices = file->info->vertices;
  if (file->data[OLX_COOKED_SECOND_UVS_CHUNK]) {
    COPY_ARRAY(file, OLX_COOKED_SECOND_UVS_CHUNK, vertices, scene->second_uvs);
  }
  if (file->data[OLX_COOKED_COLORS]) COPY_ARRAY(file, OLX_COOKED_COLORS, vertices, scene->colors);
  if (file->data[OLX_COOKED_TANGENTS]) COPY_ARRAY(file, OLX_COOKED_TANGENTS, vertices, scene->tangents);
  for (uint32_t v = 0; v < vertices; v++) {
    const char *problem = find_rare_problem(scene, v);
    if (problem) return refuse(file, "vertex", v, problem);
  }
  return OLX_OK;
}

static olx_result read_geometry(const cooked_file *file, olx_scene *scene) {
  const uint32_t vertices = file->info->vertices, triangles = file->info->triangles;
  COPY_ARRAY(file, OLX_COOKED_POSITIONS, vertices, scene->positions);
  COPY_ARRAY(file, OLX_COOKED_NORMALS, vertices, scene->normals);
  COPY_ARRAY(file, OLX_COOKED_UVS, vertices, scene->uvs);
  COPY_ARRAY(file, OLX_COOKED_TRIANGLES, triangles * 3, scene->indices);
  COPY_ARRAY(file, OLX_COOKED_TRIANGLE_MATERIALS, triangles, scene->material_index);
  scene->vertex_count = vertices;
  scene->triangle_count = triangles;
  for (uint32_t v = 0; v < vertices; v++) {
    if (!olx_scene_holds(scene, scene->positions[v]))
      return refuse(file, "vertex", v, "a position that is NaN or beyond 2e7 m");
    if (!isfinite(scene->uvs[v].x) || !isfinite(scene->uvs[v].y)) {
      return refuse(file, "vertex", v, "a texture coordinate that is not finite");
    }
  }
  for (uint32_t t = 0; t < triangles; t++) {
    const uint32_t *corner = scene->indices + (size_t)t * 3;
    if (!olx_sane_triangle(scene, scene->positions, vertices, corner)) {
      return refuse(file, "triangle", t, "a vertex out of range, or no area");
    }
    if (scene->material_index[t] >= file->info->materials) return refuse(file, "triangle", t, "no such material");
    for (uint32_t k = 0; k < 3; k++) {
      if (!is_unit(scene->normals[corner[k]])) return refuse(file, "vertex", corner[k], "a normal that is not unit");
    }
  }
  return OLX_OK;
}

static olx_result check_material(const cooked_file *file, const olx_cooked_material *m, uint32_t index) {
  const uint32_t textures[] = {m->base_color_texture, m->alpha_texture, m->metallic_roughness_texture,
                               m->emission_texture, m->normal_texture};
  for (uint32_t i = 0; i < sizeof textures / sizeof textures[0]; i++) {
    if (textures[i] != OLX_NO_TEXTURE && textures[i] >= file->info->textures) {
      return refuse(file, "material", index, "no such texture");
    }
  }
  const olx_vec3 c = olx_load3(m->base_color);
  const bool sane = is_name(m->name, sizeof m->name) && is_light(c) && olx_max3(c) <= 1.0f &&
                    is_light(olx_load3(m->emission)) && within(m->metallic, 0.0f, 1.0f) &&
                    within(m->roughness, 0.0f, 1.0f) && within(m->specular_weight, 0.0f, 1.0f) &&
                    within(m->alpha, 0.0f, 1.0f) && within(m->alpha_cutoff, 0.0f, 1e20f) &&
                    within(m->normal_scale, -1e4f, 1e4f) && !(m->flags & ~(31u | OLX_COOKED_SECOND_UVS)) &&
                    (file->data[OLX_COOKED_COLORS] || !(m->flags & OLX_COOKED_VERTEX_COLORS)) &&
                    (file->data[OLX_COOKED_SECOND_UVS_CHUNK] || !(m->flags & OLX_COOKED_SECOND_UVS));
  return sane ? OLX_OK : refuse(file, "material", index, "a name, number or flag out of range");
}

static olx_result read_materials(const cooked_file *file, olx_scene *scene) {
  const olx_cooked_material *stored = file->data[OLX_COOKED_MATERIALS];
  for (uint32_t i = 0; i < file->info->materials; i++) {
    const olx_cooked_material *m = &stored[i];
    OLX_TRY(check_material(file, m, i));
    olx_material material = {
        .base_color = olx_load3(m->base_color),
        .metallic = m->metallic,
        .roughness = m->roughness,
        .specular_weight = m->specular_weight,
        .emission = olx_load3(m->emission),
        .emits_both_sides = m->flags & OLX_COOKED_EMITS_BOTH_SIDES,
        .alpha_cutoff = m->alpha_cutoff,
        .alpha = m->alpha,
        .base_color_texture = m->base_color_texture,
        .alpha_texture = m->alpha_texture,
        .metallic_roughness_texture = m->metallic_roughness_texture,
        .emission_texture = m->emission_texture,
        .normal_texture = m->normal_texture,
        .normal_scale = m->normal_scale,
        .normal_is_height = m->flags & OLX_COOKED_NORMAL_IS_HEIGHT,
        .vertex_colors = m->flags & OLX_COOKED_VERTEX_COLORS,
        .specular_in_alpha = m->flags & OLX_COOKED_SPECULAR_IN_ALPHA,
        .blended = m->flags & OLX_COOKED_BLENDED,
        .second_uvs = (m->flags & OLX_COOKED_SECOND_UVS) >> OLX_COOKED_SECOND_UVS_SHIFT,
    };
    memcpy(material.name, m->name, sizeof material.name);
    OLX_TRY(olx_scene_add_material(scene, &material, NULL));
  }
  return OLX_OK;
}

// The textures of a scene, each decoded by one job.
typedef struct texture_jobs {
  const cooked_file *file;
  olx_texture *textures;
  const uint64_t *offsets; // where the code of each texture begins
  atomic_uint bad;         // the lowest index of a texture whose code is invalid, or the number of textures
} texture_jobs;

static void decode_texture(void *user, uint32_t index) {
  texture_jobs *jobs = user;
  const olx_cooked_texture *stored = (const olx_cooked_texture *)jobs->file->data[OLX_COOKED_TEXTURES] + index;
  const uint8_t *code = (const uint8_t *)jobs->file->data[OLX_COOKED_TEXELS] + jobs->offsets[index];
  if (olx_texel_decode(code, stored->code_bytes, stored->channels, &jobs->textures[index])) return;
  uint32_t bad = atomic_load(&jobs->bad);
  while (index < bad && !atomic_compare_exchange_weak(&jobs->bad, &bad, index)) continue;
}

static olx_result check_texture(const cooked_file *file, const olx_cooked_texture *t, uint32_t index, uint64_t left) {
  if (t->width < 1 || t->height < 1 || t->width > OLX_COOKED_MAX_TEXTURE_SIZE ||
      t->height > OLX_COOKED_MAX_TEXTURE_SIZE || (t->channels != 1 && t->channels != 3 && t->channels != 4) ||
      (t->flags & ~(uint32_t)OLX_COOKED_SRGB)) {
    return refuse(file, "texture", index, "an impossible size, channel count or flag");
  }
  // A value takes at least one bit: a bound without which a small file could claim huge memory.
  if (t->code_bytes > left || (uint64_t)t->width * t->height * t->channels > 8 * t->code_bytes) {
    return refuse(file, "texture", index, "its texels are not there");
  }
  return OLX_OK;
}

// Allocates all textures, and locates their code.
static olx_result allocate_textures(const cooked_file *file, olx_scene *scene, uint64_t *offsets) {
  const olx_cooked_texture *stored = file->data[OLX_COOKED_TEXTURES];
  uint64_t offset = 0;
  for (uint32_t i = 0; i < file->info->textures; i++) {
    const olx_cooked_texture *t = &stored[i];
    OLX_TRY(check_texture(file, t, i, file->info->texel_code_bytes - offset));
    olx_texture texture = {.width = t->width, .height = t->height, .srgb = t->flags & OLX_COOKED_SRGB};
    texture.texels = olx_allocate((size_t)t->width * t->height, 4);
    if (!texture.texels) return olx_fail(OLX_ERROR_MEMORY, "%s: out of memory", file->name);
    OLX_TRY(olx_scene_add_texture(scene, &texture, NULL));
    offsets[i] = offset;
    offset += t->code_bytes;
  }
  if (offset == file->info->texel_code_bytes) return OLX_OK;
  return olx_fail(OLX_ERROR_FORMAT, "%s: chunk TXLS: bytes after the last texture", file->name);
}

static olx_result read_textures(const cooked_file *file, olx_scene *scene) {
  const uint32_t count = file->info->textures;
  uint64_t *offsets = olx_allocate(count, sizeof *offsets);
  if (!offsets) return olx_fail(OLX_ERROR_MEMORY, "%s: out of memory", file->name);
  olx_result result = allocate_textures(file, scene, offsets);
  if (result == OLX_OK) {
    texture_jobs jobs = {.file = file, .textures = scene->textures, .offsets = offsets};
    atomic_init(&jobs.bad, count);
    result = olx_parallel_for(count, 0, decode_texture, &jobs, NULL, 0);
    const uint32_t bad = atomic_load(&jobs.bad);
    if (result == OLX_OK && bad < count) result = refuse(file, "texture", bad, "its code is broken");
  }
  olx_release(offsets);
  return result;
}

static olx_result read_lights(const cooked_file *file, olx_scene *scene) {
  scene->lights = olx_scene_array(file->info->lights, sizeof *scene->lights);
  if (!scene->lights) return olx_fail(OLX_ERROR_MEMORY, "%s: out of memory", file->name);
  const olx_cooked_light *stored = file->data[OLX_COOKED_LIGHTS];
  for (uint32_t i = 0; i < file->info->lights; i++) {
    const olx_cooked_light *l = &stored[i];
    const olx_light light = {.type = (olx_light_type)l->type,
                             .position = olx_load3(l->position),
                             .direction = olx_load3(l->direction),
                             .emission = olx_load3(l->emission),
                             .cosine_inner = l->cosine_inner,
                             .cosine_outer = l->cosine_outer};
    if (l->type > OLX_LIGHT_SPOT || !olx_scene_holds(scene, light.position) || !is_light(light.emission) ||
        !olx_finite(light.direction) || (l->type != OLX_LIGHT_POINT && !is_unit(light.direction)) ||
        !within(l->cosine_outer, -1.0f, 1.0f) || !within(l->cosine_inner, l->cosine_outer, 1.0f)) {
      return refuse(file, "light", i, "an unknown type, or a number out of range");
    }
    scene->lights[scene->light_count++] = light;
  }
  return OLX_OK;
}

static olx_result read_cameras(const cooked_file *file, olx_scene *scene) {
  const olx_cooked_camera *stored = file->data[OLX_COOKED_CAMERAS];
  for (uint32_t i = 0; i < file->info->cameras; i++) {
    const olx_cooked_camera *c = &stored[i];
    olx_camera camera = {.eye = olx_load3(c->eye),
                         .target = olx_load3(c->target),
                         .up = olx_load3(c->up),
                         .fov_y_degrees = c->fov_y_degrees};
    if (!is_name(c->name, sizeof c->name) || !olx_scene_holds(scene, camera.eye) ||
        !olx_scene_holds(scene, camera.target) || !olx_finite(camera.up) ||
        !(c->fov_y_degrees > 0.0f && c->fov_y_degrees < 180.0f)) {
      return refuse(file, "camera", i, "a name or number out of range");
    }
    memcpy(camera.name, c->name, sizeof camera.name);
    OLX_TRY(olx_scene_add_camera(scene, &camera));
  }
  return OLX_OK;
}

static olx_result read_environment(const cooked_file *file, olx_scene *scene) {
  const olx_cooked_info *info = file->info;
  olx_environment *e = &scene->environment;
  e->radiance = olx_load3(info->environment_radiance);
  e->rotation_radians = info->environment_rotation_radians;
  if (info->environment_width == 0) return OLX_OK;
  const uint32_t numbers = info->environment_width * info->environment_height * 3;
  const float *stored = file->data[OLX_COOKED_ENVIRONMENT];
  for (uint32_t i = 0; i < numbers; i++) {
    if (!(stored[i] >= 0.0f) || !isfinite(stored[i])) {
      return refuse(file, "environment texel", i / 3, "negative or not finite");
    }
  }
  COPY_ARRAY(file, OLX_COOKED_ENVIRONMENT, numbers, e->texels);
  e->width = info->environment_width;
  e->height = info->environment_height;
  return OLX_OK;
}

static olx_result read_probes(const cooked_file *file, olx_scene *scene) {
  const olx_cooked_info *info = file->info;
  olx_probe_rules *rules = &scene->probe_rules;
  scene->has_probe_volume = info->probe_flags & OLX_COOKED_PROBE_VOLUME;
  scene->has_probe_count = info->probe_flags & OLX_COOKED_PROBE_COUNT;
  rules->has_playable = info->probe_flags & OLX_COOKED_PLAYABLE;
  scene->probes_min = olx_load3(info->probes_min);
  scene->probes_max = olx_load3(info->probes_max);
  memcpy(scene->probes_count, info->probes_count, sizeof scene->probes_count);
  rules->playable = (olx_box){olx_load3(info->playable_min), olx_load3(info->playable_max)};
  rules->min_distance = info->min_distance;
  COPY_ARRAY(file, OLX_COOKED_PINNED, info->pinned, rules->pinned);
  COPY_ARRAY(file, OLX_COOKED_FORBIDDEN, info->forbidden, rules->forbidden);
  rules->pinned_count = info->pinned;
  rules->forbidden_count = info->forbidden;
  if (scene->has_probe_volume && !is_box(scene, scene->probes_min, scene->probes_max)) {
    return olx_fail(OLX_ERROR_FORMAT, "%s: chunk INFO: an impossible volume of probes", file->name);
  }
  if (rules->has_playable && !is_box(scene, rules->playable.min, rules->playable.max)) {
    return olx_fail(OLX_ERROR_FORMAT, "%s: chunk INFO: an impossible playable box", file->name);
  }
  for (uint32_t i = 0; i < info->pinned; i++) {
    if (!olx_scene_holds(scene, rules->pinned[i])) {
      return refuse(file, "pinned probe", i, "a position that is NaN or beyond 2e7 m");
    }
  }
  for (uint32_t i = 0; i < info->forbidden; i++) {
    if (!is_box(scene, rules->forbidden[i].min, rules->forbidden[i].max)) {
      return refuse(file, "forbidden box", i, "its ends are swapped, NaN or beyond 2e7 m");
    }
  }
  return OLX_OK;
}

static olx_result read_warnings(const cooked_file *file, olx_scene *scene) {
  const char *text = file->data[OLX_COOKED_WARNINGS];
  size_t left = file->info->warning_bytes;
  for (uint32_t i = 0; i < file->info->warning_count; i++) {
    const size_t length = strnlen(text, left);
    if (length == left) return refuse(file, "warning", i, "it does not end");
    olx_scene_warn(scene, "%s", text);
    text += length + 1;
    left -= length + 1;
  }
  return left == 0 ? OLX_OK : olx_fail(OLX_ERROR_FORMAT, "%s: chunk WARN: bytes after the last warning", file->name);
}

static olx_result read_scene(const olx_chunk_file *chunks, olx_scene *scene) {
  cooked_file file = {.name = chunks->name};
  OLX_TRY(find_chunks(chunks, &file));
  OLX_TRY(olx_chunk_find_origin(chunks, scene->origin));
  OLX_TRY(read_geometry(&file, scene));
  OLX_TRY(read_rare(&file, scene));
  OLX_TRY(read_materials(&file, scene));
  OLX_TRY(read_textures(&file, scene));
  OLX_TRY(read_lights(&file, scene));
  OLX_TRY(read_cameras(&file, scene));
  OLX_TRY(read_environment(&file, scene));
  OLX_TRY(read_probes(&file, scene));
  return read_warnings(&file, scene);
}

olx_result olx_scene_read_cooked(const char *path, olx_scene *scene) {
  olx_mapped_file file;
  OLX_TRY(olx_map_file(path, &file));
  const olx_chunk_file chunks = {.data = file.data, .size_bytes = file.size_bytes, .name = path};
  const olx_result result = read_scene(&chunks, scene);
  olx_unmap_file(&file);
  return result;
}
