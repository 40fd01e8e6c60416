// Reads scene descriptions in JSON: models, cameras, lights, changes of materials, and rules for placing probes.
// Messages name the file and the element that is wrong.
#include "core/file.h"
#include "core/hooks.h"
#include "core/result.h"
#include "scene/builtin/builtin.h"
#include "scene/images/texture_file.h"
#include "scene/import/import.h"
#include "scene/import/json_value.h"
#include "scene/name_index.h"
#include "scene/scene_build.h"
#include "scene/sources.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define DEGREES (OLX_PI / 180.0f)

// What a texture keeps of a texture that a description replaces in part.
typedef enum kept_part { KEPT_ALPHA, KEPT_ROUGHNESS, KEPT_METALLIC } kept_part;

typedef struct kept_texture {
  uint32_t of, index; // of the scene's textures
  kept_part part;
} kept_texture;

typedef struct description {
  const char *path;
  olx_scene *scene;
  uint32_t unknown_keys;
  olx_name_index names; // names of the models' materials, which the entries of "materials" refer to
  kept_texture *kept;   // textures that keep a part of the models' textures, shared by materials
  uint32_t kept_count, kept_capacity;
} description;

// An object of the description and its path in it: "lights[2]", or "" for the whole.
typedef struct place {
  const cJSON *object;
  char name[160];
} place;

static olx_result fail(const description *d, const place *at, const char *key, const char *what) {
  return olx_fail(OLX_ERROR_FORMAT, "%s: %s%s%s: %s", d->path, at->name, at->name[0] && key[0] ? "." : "", key, what);
}

static const cJSON *member(const place *at, const char *key) {
  return cJSON_GetObjectItemCaseSensitive(at->object, key);
}

static bool is_known(const char *key, const char *const *known) {
  for (; *known; ++known) {
    if (strcmp(key, *known) == 0) return true;
  }
  return false;
}

// Opens an object of the description: fails when the value is not an object, and warns about unknown keys (`known` ends
// with NULL).
static olx_result open_object(description *d, const place *at, const char *const *known) {
  if (!cJSON_IsObject(at->object)) return fail(d, at, "", "expected an object { ... }");
  const cJSON *item = NULL;
  cJSON_ArrayForEach(item, at->object) {
    if (is_known(item->string, known) || ++d->unknown_keys > OLX_MOST_WARNINGS_OF_A_KIND) continue;
    olx_scene_warn(d->scene, "%s: unknown key \"%s%s%.100s\" is ignored", d->path, at->name, at->name[0] ? "." : "",
                   item->string);
  }
  return OLX_OK;
}

static olx_result read_float(const description *d, const place *at, const char *key, float low, float high,
                             float *value) {
  const cJSON *item = member(at, key);
  if (!item) return OLX_OK;
  if (!olx_json_float(item, value)) return fail(d, at, key, "expected a finite number");
  if (*value >= low && *value <= high) return OLX_OK;
  char what[96];
  snprintf(what, sizeof what, "%g is not within %g to %g", (double)*value, (double)low, (double)high);
  return fail(d, at, key, what);
}

static olx_result read_vec3(const description *d, const place *at, const char *key, bool required, olx_vec3 *value) {
  const cJSON *item = member(at, key);
  float numbers[3];
  if (!item && !required) return OLX_OK;
  if (!item) return fail(d, at, key, "missing");
  if (!olx_json_floats(item, numbers, 3)) return fail(d, at, key, "expected three finite numbers [x, y, z]");
  *value = olx_v3(numbers[0], numbers[1], numbers[2]);
  return OLX_OK;
}

// Reads a vector in metres.
static olx_result read_lengths(const description *d, const place *at, const char *key, bool required, double value[3]) {
  const cJSON *item = member(at, key);
  if (!item && !required) return OLX_OK;
  if (!item) return fail(d, at, key, "missing");
  if (!olx_json_doubles(item, value, 3)) return fail(d, at, key, "expected three finite numbers [x, y, z]");
  for (int i = 0; i < 3; ++i) {
    if (!(fabs(value[i]) <= OLX_POSITION_LIMIT_METRES)) return fail(d, at, key, "coordinates must stay within 2e7");
  }
  return OLX_OK;
}

// Reads an edge vector, which the origin does not affect.
static olx_result read_edge(const description *d, const place *at, const char *key, olx_vec3 *value) {
  double lengths[3] = {0.0};
  OLX_TRY(read_lengths(d, at, key, true, lengths));
  *value = olx_v3((float)lengths[0], (float)lengths[1], (float)lengths[2]);
  return OLX_OK;
}

static olx_result read_position(const description *d, const place *at, const char *key, olx_vec3 *value) {
  double position[3] = {0.0};
  OLX_TRY(read_lengths(d, at, key, true, position));
  *value = olx_scene_local(d->scene, position);
  return OLX_OK;
}

// Reads two positions, and computes the vector from the first to the second in double precision, because local floats
// would be too coarse far from the origin.
static olx_result read_two_positions(const description *d, const place *at, const char *const keys[2], olx_vec3 *first,
                                     olx_vec3 *second, olx_vec3 *way) {
  double positions[2][3] = {{0.0}};
  for (int i = 0; i < 2; ++i) OLX_TRY(read_lengths(d, at, keys[i], true, positions[i]));
  *first = olx_scene_local(d->scene, positions[0]);
  *second = olx_scene_local(d->scene, positions[1]);
  *way = olx_v3((float)(positions[1][0] - positions[0][0]), (float)(positions[1][1] - positions[0][1]),
                (float)(positions[1][2] - positions[0][2]));
  return OLX_OK;
}

static olx_result read_light_color(const description *d, const place *at, const char *key, bool required,
                                   olx_vec3 *value) {
  OLX_TRY(read_vec3(d, at, key, required, value));
  if (value->x >= 0.0f && value->y >= 0.0f && value->z >= 0.0f && olx_max3(*value) <= OLX_MOST_EMISSION) return OLX_OK;
  return fail(d, at, key, "light cannot be negative or above 1e20");
}

static olx_result read_direction(const description *d, const place *at, const char *key, olx_vec3 *value) {
  OLX_TRY(read_vec3(d, at, key, true, value));
  const float largest = olx_max3(olx_v3(fabsf(value->x), fabsf(value->y), fabsf(value->z)));
  if (!(largest > 0.0f)) return fail(d, at, key, "a direction of length 0");
  *value = olx_normalize(olx_scale(*value, 1.0f / largest));
  return OLX_OK;
}

static olx_result read_string(const description *d, const place *at, const char *key, bool required,
                              const char **value) {
  const cJSON *item = member(at, key);
  if (!item && !required) return OLX_OK;
  if (!item) return fail(d, at, key, "missing");
  if (!cJSON_IsString(item) || !item->valuestring[0]) return fail(d, at, key, "expected a text that is not empty");
  *value = item->valuestring;
  return OLX_OK;
}

// Calls `read` for each element of an optional array.
static olx_result read_list(description *d, const place *root, const char *key,
                            olx_result (*read)(description *d, const place *at, uint32_t index)) {
  const cJSON *list = member(root, key), *element = NULL;
  if (list && !cJSON_IsArray(list)) return fail(d, root, key, "expected a list [ ... ]");
  uint32_t index = 0;
  cJSON_ArrayForEach(element, list) {
    place at = {.object = element};
    snprintf(at.name, sizeof at.name, "%.100s%s%s[%u]", root->name, root->name[0] ? "." : "", key, index);
    OLX_TRY(read(d, &at, index));
    ++index;
  }
  return OLX_OK;
}

static bool readable(char *found, size_t size_bytes, const char *folder, size_t folder_length, const char *name) {
  const bool slash = folder_length > 0 && folder[folder_length - 1] != '/';
  const int length = snprintf(found, size_bytes, "%.*s%s%s", (int)folder_length, folder, slash ? "/" : "", name);
  return length > 0 && (size_t)length < size_bytes && access(found, R_OK) == 0;
}

// Finds a file by its absolute path, otherwise beside the description, otherwise in each folder of OCTALUX_SCENES.
static olx_result find_file(const description *d, const place *at, const char *key, const char *name, char *found,
                            size_t size_bytes) {
  const char *slash = strrchr(d->path, '/'), *folders = getenv("OCTALUX_SCENES");
  if (name[0] == '/') {
    if (readable(found, size_bytes, "", 0, name)) return OLX_OK;
    return olx_fail(OLX_ERROR_FILE, "%s: %s%s%s: %.300s: not found", d->path, at->name, at->name[0] ? "." : "", key,
                    name);
  }
  if (readable(found, size_bytes, d->path, slash ? (size_t)(slash - d->path) + 1 : 0, name)) return OLX_OK;
  for (const char *folder = folders; folder && *folder;) {
    const size_t length = strcspn(folder, ":");
    if (length && readable(found, size_bytes, folder, length, name)) return OLX_OK;
    folder += length + (folder[length] == ':');
  }
  return olx_fail(OLX_ERROR_FILE, "%s: %s%s%s: %.300s: not found beside the description or in OCTALUX_SCENES (%.200s)",
                  d->path, at->name, at->name[0] ? "." : "", key, name, folders && *folders ? folders : "not set");
}

static olx_result read_model(description *d, const place *at, const char *path_key) {
  olx_placement placement = {.scale = 1.0f};
  const char *name = "";
  char path[4096];
  OLX_TRY(read_string(d, at, path_key, true, &name));
  OLX_TRY(read_float(d, at, "scale", 1e-9f, 1e9f, &placement.scale));
  OLX_TRY(read_lengths(d, at, "translate", false, placement.translate));
  for (int i = 0; i < 3; ++i) placement.translate[i] = olx_scene_length(d->scene, placement.translate[i]);
  OLX_TRY(read_vec3(d, at, "rotate_degrees", false, &placement.rotate_degrees));
  const size_t prefix = sizeof OLX_BUILTIN_PREFIX - 1;
  olx_result result;
  if (strncmp(name, OLX_BUILTIN_PREFIX, prefix) == 0) {
    result = olx_import_builtin(name + prefix, &placement, d->scene);
  } else {
    OLX_TRY(find_file(d, at, path_key, name, path, sizeof path));
    OLX_TRY(olx_scene_note_source(d->scene, path));
    result = olx_import_model(path, &placement, d->scene);
  }
  return result == OLX_OK ? OLX_OK : olx_fail(result, "%s: %s", d->path, olx_last_error());
}

static olx_result read_models_entry(description *d, const place *at, uint32_t index) {
  (void)index;
  OLX_TRY(open_object(d, at, (const char *const[]){"path", "scale", "translate", "rotate_degrees", NULL}));
  return read_model(d, at, "path");
}

static olx_result read_camera(description *d, const place *at, uint32_t index) {
  OLX_TRY(open_object(d, at, (const char *const[]){"name", "eye", "target", "up", "fov_y_degrees", NULL}));
  olx_camera camera = {.up = {0.0f, 1.0f, 0.0f}, .fov_y_degrees = 60.0f};
  char numbered[32];
  snprintf(numbered, sizeof numbered, "camera %u", index + 1);
  const char *name = numbered;
  OLX_TRY(read_string(d, at, "name", false, &name));
  if (strlen(name) >= sizeof camera.name) return fail(d, at, "name", "longer than 63 bytes");
  memcpy(camera.name, name, strlen(name) + 1);
  olx_vec3 sight;
  OLX_TRY(read_two_positions(d, at, (const char *const[]){"eye", "target"}, &camera.eye, &camera.target, &sight));
  if (member(at, "up")) OLX_TRY(read_edge(d, at, "up", &camera.up));
  OLX_TRY(read_float(d, at, "fov_y_degrees", 0.1f, 179.0f, &camera.fov_y_degrees));
  const olx_vec3 forward = olx_normalize(sight);
  if (!(olx_length(forward) > 0.5f)) return fail(d, at, "target", "it coincides with the eye");
  if (!(olx_length(olx_cross(forward, olx_normalize(camera.up))) > 1e-4f)) {
    return fail(d, at, "up", "it is parallel to the line of sight, or of length 0");
  }
  return olx_scene_add_camera(d->scene, &camera);
}

static olx_result read_sun(description *d, const place *at) {
  olx_light light = {.type = OLX_LIGHT_SUN};
  OLX_TRY(open_object(d, at, (const char *const[]){"type", "direction", "irradiance", NULL}));
  OLX_TRY(read_direction(d, at, "direction", &light.direction));
  OLX_TRY(read_light_color(d, at, "irradiance", true, &light.emission));
  return olx_scene_add_light(d->scene, &light);
}

static olx_result read_point(description *d, const place *at) {
  olx_light light = {.type = OLX_LIGHT_POINT};
  OLX_TRY(open_object(d, at, (const char *const[]){"type", "position", "intensity", NULL}));
  OLX_TRY(read_position(d, at, "position", &light.position));
  OLX_TRY(read_light_color(d, at, "intensity", true, &light.emission));
  return olx_scene_add_light(d->scene, &light);
}

static olx_result read_spot(description *d, const place *at) {
  olx_light light = {.type = OLX_LIGHT_SPOT};
  float cone[2] = {20.0f, 30.0f};
  OLX_TRY(
      open_object(d, at, (const char *const[]){"type", "position", "direction", "intensity", "cone_degrees", NULL}));
  OLX_TRY(read_position(d, at, "position", &light.position));
  OLX_TRY(read_direction(d, at, "direction", &light.direction));
  OLX_TRY(read_light_color(d, at, "intensity", true, &light.emission));
  const cJSON *cones = member(at, "cone_degrees");
  if (cones && !olx_json_floats(cones, cone, 2)) {
    return fail(d, at, "cone_degrees", "expected two half-angles [inner, outer]");
  }
  if (!(cone[0] >= 0.0f && cone[0] <= cone[1] && cone[1] > 0.0f && cone[1] <= 180.0f)) {
    return fail(d, at, "cone_degrees", "half-angles must satisfy 0 <= inner <= outer <= 180, and outer > 0");
  }
  light.cosine_inner = cosf(cone[0] * DEGREES);
  light.cosine_outer = cosf(cone[1] * DEGREES);
  return olx_scene_add_light(d->scene, &light);
}

static olx_result read_rect(description *d, const place *at) {
  olx_vec3 center = {0}, edge_u = {0}, edge_v = {0}, radiance = {0};
  OLX_TRY(open_object(d, at, (const char *const[]){"type", "center", "edge_u", "edge_v", "radiance", NULL}));
  OLX_TRY(read_position(d, at, "center", &center));
  OLX_TRY(read_edge(d, at, "edge_u", &edge_u));
  OLX_TRY(read_edge(d, at, "edge_v", &edge_v));
  OLX_TRY(read_light_color(d, at, "radiance", true, &radiance));
  const float area = olx_length(olx_cross(edge_u, edge_v));
  if (!(area > 0.0f) || !isfinite(area)) return fail(d, at, "edge_v", "the rectangle has no area, or no finite one");
  return olx_scene_add_rect_light(d->scene, center, edge_u, edge_v, radiance);
}

static olx_result read_light(description *d, const place *at, uint32_t index) {
  (void)index;
  const char *type = "";
  if (!cJSON_IsObject(at->object)) return fail(d, at, "", "expected an object { ... }");
  OLX_TRY(read_string(d, at, "type", true, &type));
  if (strcmp(type, "sun") == 0) return read_sun(d, at);
  if (strcmp(type, "rect") == 0) return read_rect(d, at);
  if (strcmp(type, "point") == 0) return read_point(d, at);
  if (strcmp(type, "spot") == 0) return read_spot(d, at);
  return fail(d, at, "type", "expected \"sun\", \"rect\", \"point\" or \"spot\"");
}

static olx_result read_environment(description *d, const place *root) {
  const place at = {.object = member(root, "environment"), .name = "environment"};
  olx_environment *environment = &d->scene->environment;
  const char *image = NULL;
  float rotation_degrees = 0.0f, gain = 1.0f;
  if (!at.object) return OLX_OK;
  OLX_TRY(open_object(d, &at, (const char *const[]){"radiance", "image", "rotation_degrees", "gain", NULL}));
  OLX_TRY(read_string(d, &at, "image", false, &image));
  if (!image) {
    if (member(&at, "gain") || member(&at, "rotation_degrees")) return fail(d, &at, "image", "missing");
    return read_light_color(d, &at, "radiance", true, &environment->radiance);
  }
  if (member(&at, "radiance")) return fail(d, &at, "radiance", "an environment has either a radiance or an image");
  OLX_TRY(read_float(d, &at, "rotation_degrees", -1e6f, 1e6f, &rotation_degrees));
  OLX_TRY(read_float(d, &at, "gain", 0.0f, 1e9f, &gain));
  char path[4096];
  uint64_t repaired = 0;
  OLX_TRY(find_file(d, &at, "image", image, path, sizeof path));
  OLX_TRY(olx_scene_note_source(d->scene, path));
  const olx_result result = olx_environment_load(path, d->scene, environment, &repaired);
  if (result != OLX_OK) return olx_fail(result, "%s: environment.image: %s", d->path, olx_last_error());
  if (repaired) {
    olx_scene_warn(d->scene, "%s: %llu numbers were negative or not finite, now 0", path, (unsigned long long)repaired);
  }
  environment->radiance = olx_splat(gain);
  environment->rotation_radians = rotation_degrees * DEGREES;
  return OLX_OK;
}

// The properties that an entry of "materials" replaces.
typedef struct material_change {
  bool base_color, roughness, metallic, specular, emission;
  olx_vec3 base_color_value, emission_value;
  float roughness_value, metallic_value, specular_value;
} material_change;

static olx_result read_material_change(description *d, const place *at, material_change *change) {
  OLX_TRY(
      open_object(d, at, (const char *const[]){"base_color", "roughness", "metallic", "specular", "emission", NULL}));
  *change = (material_change){.base_color = member(at, "base_color"),
                              .roughness = member(at, "roughness"),
                              .metallic = member(at, "metallic"),
                              .specular = member(at, "specular"),
                              .emission = member(at, "emission")};
  OLX_TRY(read_vec3(d, at, "base_color", false, &change->base_color_value));
  OLX_TRY(read_float(d, at, "roughness", 0.0f, 1.0f, &change->roughness_value));
  OLX_TRY(read_float(d, at, "metallic", 0.0f, 1.0f, &change->metallic_value));
  OLX_TRY(read_float(d, at, "specular", 0.0f, 1.0f, &change->specular_value));
  OLX_TRY(read_light_color(d, at, "emission", false, &change->emission_value));
  const olx_vec3 c = change->base_color_value;
  if (!(c.x >= 0.0f && c.y >= 0.0f && c.z >= 0.0f && olx_max3(c) <= 1.0f)) {
    return fail(d, at, "base_color", "each channel must be within 0 to 1");
  }
  if (olx_max3(c) > OLX_MOST_ALBEDO) {
    olx_scene_warn(d->scene, "%s: %s.base_color: above 0.95, clamped", d->path, at->name);
    change->base_color_value = olx_min_each(c, olx_splat(OLX_MOST_ALBEDO));
  }
  return OLX_OK;
}

static void keep_texel(kept_part part, const uint8_t from[4], uint8_t to[4]) {
  if (part == KEPT_ALPHA) {
    memset(to, from[3], 4);
    return;
  }
  memcpy(to, from, 4);
  to[part == KEPT_ROUGHNESS ? 2 : 1] = 255; // metallic is in B, roughness in G
}

// Creates a texture that keeps a part of texture `of`.
static olx_result make_kept(olx_scene *scene, uint32_t of, kept_part part, uint32_t *index) {
  olx_texture kept = scene->textures[of];
  const size_t count = (size_t)kept.width * kept.height;
  const uint8_t *texels = kept.texels;
  kept.srgb = false;
  kept.texels = olx_allocate(count, 4);
  if (!kept.texels) return olx_fail(OLX_ERROR_MEMORY, "out of memory for a texture");
  for (size_t i = 0; i < count; ++i) keep_texel(part, texels + i * 4, kept.texels + i * 4);
  return olx_scene_add_texture(scene, &kept, index);
}

static olx_result make_room(description *d) {
  if (d->kept_count < d->kept_capacity) return OLX_OK;
  const uint32_t capacity = d->kept_capacity ? d->kept_capacity * 2 : 16;
  kept_texture *grown = olx_allocate(capacity, sizeof *grown);
  if (!grown) return olx_fail(OLX_ERROR_MEMORY, "%s: out of memory", d->path);
  if (d->kept_count) memcpy(grown, d->kept, d->kept_count * sizeof *grown);
  olx_release(d->kept);
  d->kept = grown;
  d->kept_capacity = capacity;
  return OLX_OK;
}

// Replaces the index of a texture by that of one that keeps a part of it.
static olx_result keep_part(description *d, kept_part part, uint32_t *index) {
  for (uint32_t i = 0; i < d->kept_count; ++i) {
    if (d->kept[i].of != *index || d->kept[i].part != part) continue;
    *index = d->kept[i].index;
    return OLX_OK;
  }
  OLX_TRY(make_room(d));
  kept_texture kept = {.of = *index, .part = part};
  OLX_TRY(make_kept(d->scene, kept.of, part, &kept.index));
  d->kept[d->kept_count++] = kept;
  *index = kept.index;
  return OLX_OK;
}

// Keeps the alpha of the texture whose colour is replaced.
static olx_result keep_mask(description *d, olx_material *m) {
  if (m->base_color_texture == OLX_NO_TEXTURE || m->alpha_cutoff <= 0.0f || m->alpha_texture != OLX_NO_TEXTURE) {
    return OLX_OK;
  }
  m->alpha_texture = m->base_color_texture;
  if (m->second_uvs & OLX_SLOT_BASE_COLOR) m->second_uvs |= OLX_SLOT_ALPHA;
  return keep_part(d, KEPT_ALPHA, &m->alpha_texture);
}

// Roughness and metallic share a texture, which keeps the one that is not replaced.
static olx_result replace_roughness_and_metallic(description *d, const material_change *change, olx_material *m) {
  uint32_t *texture = &m->metallic_roughness_texture;
  if (change->roughness && change->metallic) *texture = OLX_NO_TEXTURE;
  if (change->metallic) m->metallic = change->metallic_value;
  if (change->roughness) m->roughness = change->roughness_value;
  if (*texture == OLX_NO_TEXTURE || change->roughness == change->metallic) return OLX_OK;
  return keep_part(d, change->roughness ? KEPT_METALLIC : KEPT_ROUGHNESS, texture);
}

static olx_result apply_change(description *d, const material_change *change, olx_material *m) {
  if (change->base_color) {
    OLX_TRY(keep_mask(d, m));
    m->base_color = change->base_color_value;
    m->base_color_texture = OLX_NO_TEXTURE;
    m->vertex_colors = false;
  }
  OLX_TRY(replace_roughness_and_metallic(d, change, m));
  // Roughness affects only the specular lobe, so that the material gets one.
  if (change->specular || change->roughness) {
    m->specular_weight = change->specular ? change->specular_value : 1.0f;
    m->specular_in_alpha = false;
  }
  if (change->emission) {
    m->emission = change->emission_value;
    m->emission_texture = OLX_NO_TEXTURE;
  }
  return OLX_OK;
}

static olx_result apply_to_all(description *d, const material_change *change, uint32_t *matches) {
  for (uint32_t i = 0; i < d->scene->material_count; ++i) {
    if (d->scene->materials[i].rectangle_light) continue;
    OLX_TRY(apply_change(d, change, &d->scene->materials[i]));
    ++*matches;
  }
  return OLX_OK;
}

static olx_result apply_to_named(description *d, const char *name, const material_change *change, uint32_t *matches) {
  for (uint32_t i = olx_name_index_find(&d->names, name, OLX_NO_ELEMENT); i != OLX_NO_ELEMENT;
       i = olx_name_index_find(&d->names, name, i)) {
    if (strcmp(d->scene->materials[i].name, name) != 0) continue;
    OLX_TRY(apply_change(d, change, &d->scene->materials[i]));
    ++*matches;
  }
  return OLX_OK;
}

// Reads "*" first, so that a material's own entry takes precedence wherever it is in the file.
static olx_result read_materials(description *d, const place *root, bool everyone) {
  const cJSON *materials = member(root, "materials"), *item = NULL;
  if (materials && !cJSON_IsObject(materials)) return fail(d, root, "materials", "expected an object { ... }");
  cJSON_ArrayForEach(item, materials) {
    if ((strcmp(item->string, "*") == 0) != everyone) continue;
    place at = {.object = item};
    snprintf(at.name, sizeof at.name, "materials.%.127s", item->string);
    material_change change;
    OLX_TRY(read_material_change(d, &at, &change));
    uint32_t matches = 0;
    OLX_TRY(everyone ? apply_to_all(d, &change, &matches) : apply_to_named(d, item->string, &change, &matches));
    if (!matches) olx_scene_warn(d->scene, "%s: %s: no material of that name", d->path, at.name);
  }
  return OLX_OK;
}

static olx_result index_materials(description *d) {
  while (d->names.count < d->scene->material_count) {
    OLX_TRY(olx_name_index_add(&d->names, d->scene->materials[d->names.count].name));
  }
  return OLX_OK;
}

static olx_result read_probe_counts(description *d, const place *at) {
  const cJSON *counts = member(at, "grid");
  float numbers[3];
  if (!counts) return OLX_OK;
  if (!olx_json_floats(counts, numbers, 3)) return fail(d, at, "grid", "expected three whole numbers [x, y, z]");
  for (int i = 0; i < 3; ++i) {
    if (!(numbers[i] >= 1.0f && numbers[i] <= 1024.0f) || numbers[i] != floorf(numbers[i])) {
      return fail(d, at, "grid", "each count must be a whole number within 1 to 1024");
    }
    d->scene->probes_count[i] = (uint32_t)numbers[i];
  }
  d->scene->has_probe_count = true;
  return OLX_OK;
}

static olx_result read_box(description *d, const place *at, olx_box *box) {
  OLX_TRY(open_object(d, at, (const char *const[]){"min", "max", NULL}));
  olx_vec3 extent;
  OLX_TRY(read_two_positions(d, at, (const char *const[]){"min", "max"}, &box->min, &box->max, &extent));
  if (extent.x >= 0.0f && extent.y >= 0.0f && extent.z >= 0.0f) return OLX_OK;
  return fail(d, at, "max", "it lies below min");
}

static olx_result read_forbidden(description *d, const place *at, uint32_t index) {
  d->scene->probe_rules.forbidden_count = index + 1;
  return read_box(d, at, &d->scene->probe_rules.forbidden[index]);
}

static olx_result read_pinned(const description *d, const place *at, const cJSON *list) {
  olx_probe_rules *rules = &d->scene->probe_rules;
  const cJSON *element = NULL;
  cJSON_ArrayForEach(element, list) {
    double position[3];
    char key[32];
    snprintf(key, sizeof key, "pinned[%u]", rules->pinned_count);
    if (!olx_json_doubles(element, position, 3)) return fail(d, at, key, "expected three finite numbers [x, y, z]");
    const olx_vec3 pinned = olx_scene_local(d->scene, position);
    if (!olx_scene_holds(d->scene, pinned)) return fail(d, at, key, "coordinates must stay within 2e7");
    rules->pinned[rules->pinned_count++] = pinned;
  }
  return OLX_OK;
}

// Reads the rules for the placement of probes.
static olx_result read_probe_rules(description *d, const place *at) {
  olx_probe_rules *rules = &d->scene->probe_rules;
  const place playable = {.object = member(at, "playable"), .name = "probes.playable"};
  const cJSON *pinned = member(at, "pinned"), *forbidden = member(at, "forbidden");
  if (pinned && !cJSON_IsArray(pinned)) return fail(d, at, "pinned", "expected a list [ ... ]");
  rules->pinned = olx_allocate((size_t)cJSON_GetArraySize(pinned), sizeof *rules->pinned);
  rules->forbidden = olx_allocate((size_t)cJSON_GetArraySize(forbidden), sizeof *rules->forbidden);
  if (!rules->pinned || !rules->forbidden) return olx_fail(OLX_ERROR_MEMORY, "%s: out of memory", d->path);
  OLX_TRY(read_pinned(d, at, pinned));
  OLX_TRY(read_list(d, at, "forbidden", read_forbidden));
  if (playable.object) OLX_TRY(read_box(d, &playable, &rules->playable));
  rules->has_playable = playable.object != NULL;
  return read_float(d, at, "min_distance", 0.0f, 1e9f, &rules->min_distance);
}

static olx_result read_probes(description *d, const place *root) {
  const place at = {.object = member(root, "probes"), .name = "probes"};
  olx_scene *scene = d->scene;
  if (!at.object) return OLX_OK;
  OLX_TRY(open_object(
      d, &at, (const char *const[]){"min", "max", "grid", "pinned", "forbidden", "playable", "min_distance", NULL}));
  OLX_TRY(read_probe_counts(d, &at));
  OLX_TRY(read_probe_rules(d, &at));
  if (!member(&at, "min") && !member(&at, "max")) return OLX_OK;
  olx_vec3 extent;
  OLX_TRY(
      read_two_positions(d, &at, (const char *const[]){"min", "max"}, &scene->probes_min, &scene->probes_max, &extent));
  const float extents[3] = {extent.x, extent.y, extent.z};
  for (int i = 0; i < 3; ++i) {
    if (!(extents[i] >= 0.0f)) return fail(d, &at, "max", "it lies below min");
    if (!(extents[i] > 0.0f) && scene->has_probe_count && scene->probes_count[i] > 1) {
      return fail(d, &at, "max", "it equals min along an axis with more than one probe");
    }
  }
  scene->has_probe_volume = true;
  return OLX_OK;
}

static olx_result read_description(description *d, const place *root) {
  OLX_TRY(open_object(d, root,
                      (const char *const[]){"model", "models", "scale", "translate", "rotate_degrees", "cameras",
                                            "lights", "environment", "materials", "probes", NULL}));
  const cJSON *models = member(root, "models");
  if (!member(root, "model") && (!models || (cJSON_IsArray(models) && !models->child))) {
    return fail(d, root, "model", "missing, and there are no \"models\"");
  }
  // Cheap checks precede slow models; the description's cameras precede the models' own.
  OLX_TRY(read_list(d, root, "cameras", read_camera));
  OLX_TRY(read_probes(d, root));
  OLX_TRY(read_environment(d, root));
  const olx_environment environment = d->scene->environment;
  if (member(root, "model")) OLX_TRY(read_model(d, root, "model"));
  OLX_TRY(read_list(d, root, "models", read_models_entry));
  if (member(root, "environment")) d->scene->environment = environment; // in place of a built-in scene's
  OLX_TRY(index_materials(d));
  OLX_TRY(read_materials(d, root, true));
  OLX_TRY(read_materials(d, root, false));
  OLX_TRY(read_list(d, root, "lights", read_light));
  if (d->unknown_keys > OLX_MOST_WARNINGS_OF_A_KIND) {
    olx_scene_warn(d->scene, "%s: %u more unknown keys are ignored", d->path,
                   d->unknown_keys - OLX_MOST_WARNINGS_OF_A_KIND);
  }
  return OLX_OK;
}

olx_result olx_import_description(const char *path, olx_scene *scene) {
  olx_mapped_file file;
  OLX_TRY(olx_map_file(path, &file));
  place root = {0};
  cJSON *json = NULL;
  olx_result result = olx_json_parse(path, file.data, file.size_bytes, &json);
  olx_unmap_file(&file);
  if (result != OLX_OK) return result;
  description d = {.path = path, .scene = scene};
  root.object = json;
  result = read_description(&d, &root);
  olx_name_index_free(&d.names);
  olx_release(d.kept);
  cJSON_Delete(json);
  return result;
}
