// Builds a scene: appends meshes, materials, textures and lights, skips what is degenerate with a warning, and computes
// bounds and hash at the end.
#include "scene/scene_build.h"

#include "core/hooks.h"
#include "core/result.h"
#include "field/lights.h"
#include "scene/scene_parts.h"
#include "scene/sources.h"

#include <assert.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

// Returns the capacity of an array: the next power of two of its count, so that capacities need not be stored.
static uint64_t capacity_for(uint64_t count) {
  uint64_t capacity = 16;
  while (capacity < count) capacity *= 2;
  return capacity;
}

// Replaces an array by one with its `count` elements and room for `added` more; NULL when memory runs out.
static void *grow(void *array, uint32_t count, uint32_t added, size_t element_bytes) {
  const uint64_t wanted = (uint64_t)count + added;
  if (array && capacity_for(count) >= wanted) return array;
  void *grown = olx_allocate((size_t)capacity_for(wanted), element_bytes);
  if (!grown) return NULL;
  if (count) memcpy(grown, array, (size_t)count * element_bytes);
  olx_release(array);
  return grown;
}

void *olx_scene_array(uint32_t count, size_t element_bytes) {
  return olx_allocate((size_t)capacity_for(count), element_bytes);
}

// Reserves room for an attribute that few meshes have: `array` is NULL until a mesh has it, and earlier vertices get
// `otherwise`.
static olx_result reserve_rare(void **array, bool wanted, uint32_t count, uint32_t added, size_t element_bytes,
                               const void *otherwise) {
  if (!*array && !wanted) return OLX_OK;
  uint8_t *grown = *array ? grow(*array, count, added, element_bytes)
                          : olx_allocate((size_t)capacity_for((uint64_t)count + added), element_bytes);
  if (!grown) return olx_fail(OLX_ERROR_MEMORY, "out of memory for the scene");
  for (uint32_t i = 0; !*array && i < count; ++i) memcpy(grown + i * element_bytes, otherwise, element_bytes);
  *array = grown;
  return OLX_OK;
}

#define RESERVE(array, count, added)                                                                                   \
  do {                                                                                                                 \
    void *const grown_ = grow((array), (count), (added), sizeof *(array));                                             \
    if (!grown_) return olx_fail(OLX_ERROR_MEMORY, "out of memory for the scene");                                     \
    (array) = grown_;                                                                                                  \
  } while (0)

void olx_scene_warn(olx_scene *scene, const char *format, ...) {
  char message[1024], printable[sizeof message];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(message, sizeof message, format, arguments);
  va_end(arguments);
  olx_printable(message, printable, sizeof printable);
  char **grown = grow(scene->warnings, scene->warning_count, 1, sizeof *grown);
  if (!grown) return;
  scene->warnings = grown;
  char *copy = olx_copy_string(printable);
  if (copy) scene->warnings[scene->warning_count++] = copy;
}

void olx_scene_log_warnings(const olx_scene *scene) {
  for (uint32_t i = 0; i < scene->warning_count; ++i) olx_log(OLX_LOG_WARNING, "%s", scene->warnings[i]);
}

olx_material olx_material_default(void) {
  return (olx_material){
      .base_color = olx_splat(0.8f),
      .roughness = 1.0f,
      .alpha = 1.0f,
      .base_color_texture = OLX_NO_TEXTURE,
      .alpha_texture = OLX_NO_TEXTURE,
      .metallic_roughness_texture = OLX_NO_TEXTURE,
      .emission_texture = OLX_NO_TEXTURE,
      .normal_texture = OLX_NO_TEXTURE,
      .normal_scale = 1.0f,
  };
}

olx_result olx_scene_add_material(olx_scene *scene, const olx_material *material, uint32_t *index) {
  RESERVE(scene->materials, scene->material_count, 1);
  if (index) *index = scene->material_count;
  scene->materials[scene->material_count++] = *material;
  return OLX_OK;
}

olx_result olx_scene_add_texture(olx_scene *scene, const olx_texture *texture, uint32_t *index) {
  olx_texture *grown = grow(scene->textures, scene->texture_count, 1, sizeof *grown);
  if (!grown) {
    olx_release(texture->texels);
    return olx_fail(OLX_ERROR_MEMORY, "out of memory for the scene");
  }
  scene->textures = grown;
  if (index) *index = scene->texture_count;
  scene->textures[scene->texture_count++] = *texture;
  return OLX_OK;
}

olx_result olx_scene_add_light(olx_scene *scene, const olx_light *light) {
  assert(!olx_light_varies(light));
  olx_light checked = *light;
  if (!olx_scene_holds(scene, light->position) || !olx_finite(light->direction) || !olx_finite(light->emission)) {
    return olx_fail(OLX_ERROR_ARGUMENT, "a light's position, direction or emission is not finite or beyond 2e7 m");
  }
  if (light->type != OLX_LIGHT_POINT) {
    checked.direction = olx_normalize(light->direction);
    if (!(fabsf(olx_length(checked.direction) - 1.0f) < 1e-3f)) {
      return olx_fail(OLX_ERROR_ARGUMENT, "a light's direction has no length");
    }
  }
  RESERVE(scene->lights, scene->light_count, 1);
  scene->lights[scene->light_count++] = checked;
  return OLX_OK;
}

olx_result olx_scene_add_camera(olx_scene *scene, const olx_camera *camera) {
  RESERVE(scene->cameras, scene->camera_count, 1);
  scene->cameras[scene->camera_count++] = *camera;
  return OLX_OK;
}

olx_result olx_scene_add_rect_light(olx_scene *scene, olx_vec3 center, olx_vec3 edge_u, olx_vec3 edge_v,
                                    olx_vec3 radiance) {
  const olx_vec3 normal = olx_cross(edge_u, edge_v);
  const float area = olx_length(normal);
  if (!olx_scene_holds(scene, center) || !olx_finite(edge_u) || !olx_finite(edge_v) || !(area > 0.0f) ||
      !isfinite(area)) {
    return olx_fail(OLX_ERROR_ARGUMENT, "a rectangle light has no area, or is not finite");
  }
  olx_material material = olx_material_default();
  snprintf(material.name, sizeof material.name, "rectangle light %u", (unsigned)scene->material_count);
  material.base_color = olx_splat(0.0f);
  material.emission = radiance;
  material.rectangle_light = true;
  uint32_t index = 0;
  OLX_TRY(olx_scene_add_material(scene, &material, &index));
  const olx_vec3 corner = olx_madd(olx_madd(center, edge_u, -0.5f), edge_v, -0.5f);
  const olx_vec3 positions[4] = {corner, olx_add(corner, edge_u), olx_add(olx_add(corner, edge_u), edge_v),
                                 olx_add(corner, edge_v)};
  const uint32_t indices[6] = {0, 1, 2, 0, 2, 3};
  return olx_scene_add_mesh(scene, material.name, positions, NULL, NULL, 4, indices, 2, index);
}

// The reason why a triangle is skipped.
typedef enum triangle_fault { FAULT_NONE, FAULT_INDEX, FAULT_POSITION, FAULT_AREA, FAULT_COUNT } triangle_fault;

static triangle_fault judge_triangle(const olx_scene *scene, const olx_vec3 *positions, uint32_t vertex_count,
                                     const uint32_t corner[3]) {
  if (corner[0] >= vertex_count || corner[1] >= vertex_count || corner[2] >= vertex_count) return FAULT_INDEX;
  const olx_vec3 a = positions[corner[0]], b = positions[corner[1]], c = positions[corner[2]];
  if (!olx_scene_holds(scene, a) || !olx_scene_holds(scene, b) || !olx_scene_holds(scene, c)) return FAULT_POSITION;
  // Computed in floats, like normals everywhere.
  const float area = olx_length(olx_cross(olx_sub(b, a), olx_sub(c, a)));
  return area > 0.0f && isfinite(area) ? FAULT_NONE : FAULT_AREA;
}

bool olx_sane_triangle(const olx_scene *scene, const olx_vec3 *positions, uint32_t vertex_count,
                       const uint32_t corner[3]) {
  return judge_triangle(scene, positions, vertex_count, corner) == FAULT_NONE;
}

static const olx_vec4 white = {1.0f, 1.0f, 1.0f, 1.0f}, no_tangent = {0.0f, 0.0f, 0.0f, 0.0f};
static const olx_vec2 no_uv = {0.0f, 0.0f};

#define RESERVE_RARE(array, wanted, count, added, otherwise)                                                           \
  do {                                                                                                                 \
    void *rare_ = (array);                                                                                             \
    OLX_TRY(reserve_rare(&rare_, (wanted), (count), (added), sizeof *(array), (otherwise)));                           \
    (array) = rare_;                                                                                                   \
  } while (0)

static olx_result reserve_mesh(olx_scene *scene, const olx_mesh *mesh) {
  const uint32_t triangles = mesh->triangle_count, vertices = mesh->normals ? mesh->vertex_count : triangles * 3;
  const uint32_t v = scene->vertex_count, t = scene->triangle_count;
  if ((uint64_t)t + triangles >= UINT32_MAX / 3 || (uint64_t)v + vertices >= UINT32_MAX) {
    return olx_fail(OLX_ERROR_UNSUPPORTED, "the scene has more than %u triangles or %u vertices", UINT32_MAX / 3,
                    UINT32_MAX);
  }
  RESERVE(scene->positions, v, vertices);
  RESERVE(scene->normals, v, vertices);
  RESERVE(scene->uvs, v, vertices);
  RESERVE_RARE(scene->second_uvs, mesh->second_uvs != NULL, v, vertices, &no_uv);
  RESERVE_RARE(scene->colors, mesh->colors != NULL, v, vertices, &white);
  RESERVE_RARE(scene->tangents, mesh->tangents != NULL, v, vertices, &no_tangent);
  RESERVE(scene->indices, t * 3, triangles * 3);
  RESERVE(scene->material_index, t, triangles);
  return OLX_OK;
}

static olx_vec3 triangle_normal(const olx_vec3 *positions, const uint32_t corner[3]) {
  const olx_vec3 a = positions[corner[0]];
  return olx_normalize(olx_cross(olx_sub(positions[corner[1]], a), olx_sub(positions[corner[2]], a)));
}

static bool is_unit(olx_vec3 n) { return fabsf(olx_dot(n, n) - 1.0f) < 1e-3f; }

static olx_vec2 uv_of(const olx_vec2 *uvs, uint32_t vertex) {
  return uvs && isfinite(uvs[vertex].x) && isfinite(uvs[vertex].y) ? uvs[vertex] : no_uv;
}

// Appends vertex `from` of a mesh, with the given position and normal.
static void append_vertex(olx_scene *scene, const olx_mesh *mesh, uint32_t from, olx_vec3 position, olx_vec3 normal) {
  const uint32_t v = scene->vertex_count++;
  scene->positions[v] = position;
  scene->normals[v] = normal;
  scene->uvs[v] = uv_of(mesh->uvs, from);
  if (scene->second_uvs) scene->second_uvs[v] = uv_of(mesh->second_uvs, from);
  if (scene->colors) scene->colors[v] = mesh->colors ? mesh->colors[from] : white;
  if (scene->tangents) scene->tangents[v] = mesh->tangents ? mesh->tangents[from] : no_tangent;
}

static void append_triangle(olx_scene *scene, const uint32_t corner[3], uint32_t material) {
  const uint32_t t = scene->triangle_count++;
  memcpy(scene->indices + (size_t)t * 3, corner, 3 * sizeof *corner);
  scene->material_index[t] = material;
}

// Appends triangles without normals, each with three separate vertices.
static void append_flat(olx_scene *scene, const olx_mesh *mesh, const uint32_t corner[3]) {
  const uint32_t first = scene->vertex_count;
  const olx_vec3 normal = triangle_normal(mesh->positions, corner);
  for (uint32_t k = 0; k < 3; ++k) append_vertex(scene, mesh, corner[k], mesh->positions[corner[k]], normal);
  append_triangle(scene, (const uint32_t[3]){first, first + 1, first + 2}, mesh->material);
}

// Gives a vertex whose normal is invalid that of the first triangle that uses it.
static void append_shared(olx_scene *scene, uint32_t first, const uint32_t corner[3], uint32_t material) {
  const uint32_t moved[3] = {first + corner[0], first + corner[1], first + corner[2]};
  for (uint32_t k = 0; k < 3; ++k) {
    if (!is_unit(scene->normals[moved[k]])) scene->normals[moved[k]] = triangle_normal(scene->positions, moved);
  }
  append_triangle(scene, moved, material);
}

// A model may have a thousand meshes with such triangles, which bury what matters more.
enum { MOST_MESHES_NAMED = 4 };

static void warn_about_faults(olx_scene *scene, const char *name, const uint32_t faults[FAULT_COUNT],
                              uint32_t triangle_count) {
  const uint32_t skipped = faults[FAULT_INDEX] + faults[FAULT_POSITION] + faults[FAULT_AREA];
  if (!skipped) return;
  if (scene->skipping_meshes++ >= MOST_MESHES_NAMED) {
    scene->unreported_triangles += skipped;
    return;
  }
  olx_scene_warn(scene,
                 "%s: skipped %u of %u triangles (%u without area, %u with a position that is NaN or beyond 2e7 m, %u "
                 "with a vertex index out of range)",
                 name, skipped, triangle_count, faults[FAULT_AREA], faults[FAULT_POSITION], faults[FAULT_INDEX]);
}

void olx_scene_warn_about_rest(olx_scene *scene, const char *path) {
  if (scene->skipping_meshes > MOST_MESHES_NAMED) {
    olx_scene_warn(scene, "%s: skipped %llu more triangles of %u more meshes", path,
                   (unsigned long long)scene->unreported_triangles, scene->skipping_meshes - MOST_MESHES_NAMED);
  }
  scene->skipping_meshes = 0;
  scene->unreported_triangles = 0;
}

static void append_vertices(olx_scene *scene, const olx_mesh *mesh) {
  for (uint32_t i = 0; i < mesh->vertex_count; ++i) {
    const olx_vec3 normal = olx_finite(mesh->normals[i]) ? olx_normalize(mesh->normals[i]) : olx_splat(0.0f);
    const olx_vec3 position = olx_scene_holds(scene, mesh->positions[i]) ? mesh->positions[i] : olx_splat(0.0f);
    append_vertex(scene, mesh, i, position, normal);
  }
}

olx_result olx_scene_append_mesh(olx_scene *scene, const char *name, const olx_mesh *mesh) {
  if (mesh->triangle_count >= UINT32_MAX / 3) {
    return olx_fail(OLX_ERROR_UNSUPPORTED, "%s: %u triangles are too many", name, mesh->triangle_count);
  }
  OLX_TRY(reserve_mesh(scene, mesh));
  const uint32_t first = scene->vertex_count;
  if (mesh->normals) append_vertices(scene, mesh);
  if (mesh->colors) scene->materials[mesh->material].vertex_colors = true;
  uint32_t faults[FAULT_COUNT] = {0};
  for (uint32_t t = 0; t < mesh->triangle_count; ++t) {
    const uint32_t *corner = mesh->indices + (size_t)t * 3;
    const triangle_fault fault = judge_triangle(scene, mesh->positions, mesh->vertex_count, corner);
    ++faults[fault];
    for (uint32_t k = 0; k < 3 && (fault == FAULT_NONE || fault == FAULT_AREA); ++k) {
      olx_scene_include(scene, mesh->positions[corner[k]]);
    }
    if (fault != FAULT_NONE) continue;
    if (mesh->normals) append_shared(scene, first, corner, mesh->material);
    else append_flat(scene, mesh, corner);
  }
  warn_about_faults(scene, name, faults, mesh->triangle_count);
  return OLX_OK;
}

olx_result olx_scene_add_mesh(olx_scene *scene, const char *name, const olx_vec3 *positions, const olx_vec3 *normals,
                              const olx_vec2 *uvs, uint32_t vertex_count, const uint32_t *indices,
                              uint32_t triangle_count, uint32_t material) {
  return olx_scene_append_mesh(scene, name,
                               &(olx_mesh){.positions = positions,
                                           .normals = normals,
                                           .uvs = uvs,
                                           .indices = indices,
                                           .vertex_count = vertex_count,
                                           .triangle_count = triangle_count,
                                           .material = material});
}

static void compute_bounds(olx_scene *scene) {
  olx_vec3 low = olx_splat(INFINITY), high = olx_splat(-INFINITY);
  for (size_t i = 0; i < (size_t)scene->triangle_count * 3; ++i) {
    const olx_vec3 p = scene->positions[scene->indices[i]];
    low = olx_min_each(low, p);
    high = olx_max_each(high, p);
  }
  scene->bounds_min = low;
  scene->bounds_max = high;
}

static olx_result count_area_lights(olx_scene *scene) {
  bool *used = olx_allocate_zero(scene->material_count, sizeof *used);
  if (!used) return olx_fail(OLX_ERROR_MEMORY, "out of memory for the scene");
  for (uint32_t t = 0; t < scene->triangle_count; ++t) used[scene->material_index[t]] = true;
  scene->area_light_count = 0;
  for (uint32_t m = 0; m < scene->material_count; ++m) {
    scene->area_light_count += used[m] && olx_max3(scene->materials[m].emission) > 0.0f;
  }
  olx_release(used);
  return OLX_OK;
}

// Materials whose meshes were left out may name second texture coordinates that no mesh has.
static void forget_missing_uvs(olx_scene *scene) {
  for (uint32_t m = 0; !scene->second_uvs && m < scene->material_count; ++m) scene->materials[m].second_uvs = 0;
}

olx_result olx_scene_summarize(olx_scene *scene) {
  if (scene->triangle_count == 0) return olx_fail(OLX_ERROR_EMPTY, "the scene has no triangles");
  compute_bounds(scene);
  forget_missing_uvs(scene);
  OLX_TRY(count_area_lights(scene));
  scene->hash = olx_scene_hash(scene);
  return OLX_OK;
}

void olx_scene_release_arrays(olx_scene *scene) {
  for (uint32_t i = 0; i < scene->texture_count; ++i) olx_release(scene->textures[i].texels);
  for (uint32_t i = 0; i < scene->warning_count; ++i) olx_release(scene->warnings[i]);
  olx_release(scene->positions);
  olx_release(scene->normals);
  olx_release(scene->uvs);
  olx_release(scene->second_uvs);
  olx_release(scene->colors);
  olx_release(scene->tangents);
  olx_release(scene->indices);
  olx_release(scene->material_index);
  olx_release(scene->materials);
  olx_release(scene->textures);
  olx_release(scene->lights);
  olx_release(scene->cameras);
  olx_release(scene->environment.texels);
  olx_release(scene->warnings);
  olx_release(scene->probe_rules.pinned);
  olx_release(scene->probe_rules.forbidden);
  olx_scene_release_sources(scene);
}
