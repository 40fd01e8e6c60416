// Imports the primitives of glTF meshes, once for each node that refers to them, directly into arrays in scene space.
// The material determines which attributes are read.
#include "scene/gltf/gltf_mesh.h"

#include "core/hooks.h"
#include "core/result.h"
#include "scene/gltf/gltf_accessor.h"
#include "scene/gltf/gltf_draco.h"
#include "scene/scene_build.h"

#include <stdio.h>
#include <string.h>

// Bound on the attributes of a primitive, which every instance searches.
#define MOST_ATTRIBUTES 256

enum { MODE_POINTS, MODE_LINES, MODE_LOOP, MODE_LINE_STRIP, MODE_TRIANGLES, MODE_STRIP, MODE_FAN, MODES };

static const olx_gltf_accessor *accessor_at(const olx_gltf *gltf, uint32_t index) {
  return index == OLX_GLTF_NONE ? NULL : &gltf->accessor_data[index];
}

// Returns the accessor of an attribute; OLX_GLTF_NONE when the primitive has no attribute of that name.
static uint32_t find_attribute(const olx_gltf *gltf, const cJSON *primitive, const char *name) {
  uint32_t index;
  olx_gltf_index(olx_json_member(primitive, "attributes"), name, gltf->accessors.count, &index);
  return index;
}

// ---- Checks

static bool fits_vector(const olx_gltf_accessor *a, uint32_t fewest, uint32_t most) {
  return a->components >= fewest && a->components <= most && a->type != OLX_GLTF_UINT32;
}

static const char *find_mismatch(const char *name, const olx_gltf_accessor *a) {
  const struct {
    const char *name;
    size_t length;
    uint32_t fewest, most;
    const char *wanted;
  } rows[] = {{"POSITION", 9, 3, 3, "three"}, {"NORMAL", 7, 3, 3, "three"},          {"TANGENT", 8, 4, 4, "four"},
              {"TEXCOORD_", 9, 2, 2, "two"},  {"COLOR_0", 8, 3, 4, "three or four"}, {"JOINTS_0", 9, 4, 4, "four"},
              {"WEIGHTS_0", 10, 4, 4, "four"}};
  for (size_t i = 0; i < sizeof rows / sizeof *rows; ++i) {
    if (strncmp(name, rows[i].name, rows[i].length) != 0) continue;
    return fits_vector(a, rows[i].fewest, rows[i].most) ? NULL : rows[i].wanted;
  }
  return NULL;
}

static olx_result check_attribute(const olx_gltf *gltf, uint32_t mesh, const cJSON *attribute) {
  uint32_t index = 0;
  bool valid;
  if (!olx_json_index(attribute, gltf->accessors.count, &index, &valid)) {
    return olx_gltf_fail(gltf, "meshes", mesh, "an attribute's accessor does not exist");
  }
  const char *wanted = find_mismatch(attribute->string, &gltf->accessor_data[index]);
  if (!wanted) return OLX_OK;
  return olx_fail(OLX_ERROR_UNSUPPORTED, "%s: meshes[%u]: %.100s is not made of %s floats or 8 or 16 bit integers",
                  gltf->path, mesh, attribute->string, wanted);
}

static olx_result check_indices(const olx_gltf *gltf, uint32_t mesh, const cJSON *primitive) {
  uint32_t index;
  if (!olx_gltf_index(primitive, "indices", gltf->accessors.count, &index)) {
    return olx_gltf_fail(gltf, "meshes", mesh, "the accessor of its indices does not exist");
  }
  const olx_gltf_accessor *a = accessor_at(gltf, index);
  if (!a ||
      (a->components == 1 && a->type != OLX_GLTF_INT8 && a->type != OLX_GLTF_INT16 && a->type != OLX_GLTF_FLOAT)) {
    return OLX_OK;
  }
  return olx_gltf_fail(gltf, "meshes", mesh, "its indices are not unsigned numbers");
}

// Returns the number of corners of a primitive, by its indices where it has them.
static uint64_t corner_count(const olx_gltf *gltf, const cJSON *primitive) {
  uint32_t index;
  olx_gltf_index(primitive, "indices", gltf->accessors.count, &index);
  if (index == OLX_GLTF_NONE) index = find_attribute(gltf, primitive, "POSITION");
  return index == OLX_GLTF_NONE ? 0 : gltf->accessor_data[index].count;
}

static olx_result check_mode(const olx_gltf *gltf, uint32_t mesh, const cJSON *primitive) {
  static const uint64_t fewest[MODES] = {1, 2, 2, 2, 3, 3, 3};
  uint64_t mode;
  if (!olx_json_size(primitive, "mode", MODE_TRIANGLES, &mode) || mode >= MODES) {
    return olx_gltf_fail(gltf, "meshes", mesh, "its mode is not known");
  }
  if (find_attribute(gltf, primitive, "POSITION") == OLX_GLTF_NONE) return OLX_OK;
  if (corner_count(gltf, primitive) >= fewest[mode]) return OLX_OK;
  return olx_gltf_fail(gltf, "meshes", mesh, "it has too few corners for its mode");
}

static olx_result check_primitive(const olx_gltf *gltf, uint32_t mesh, const cJSON *primitive) {
  const cJSON *attributes = olx_json_member(primitive, "attributes"), *attribute = NULL;
  uint32_t material;
  if (!olx_gltf_index(primitive, "material", gltf->materials.count, &material)) {
    return olx_gltf_fail(gltf, "meshes", mesh, "its material does not exist");
  }
  if (!cJSON_IsObject(attributes)) return olx_gltf_fail(gltf, "meshes", mesh, "it has no attributes");
  if (cJSON_GetArraySize(attributes) > MOST_ATTRIBUTES) {
    return olx_gltf_fail(gltf, "meshes", mesh, "a primitive has more than 256 attributes");
  }
  cJSON_ArrayForEach(attribute, attributes) OLX_TRY(check_attribute(gltf, mesh, attribute));
  OLX_TRY(check_indices(gltf, mesh, primitive));
  OLX_TRY(olx_gltf_check_draco(gltf, mesh, primitive));
  return check_mode(gltf, mesh, primitive);
}

olx_result olx_gltf_check_meshes(const olx_gltf *gltf) {
  for (uint32_t i = 0; i < gltf->meshes.count; ++i) {
    const cJSON *primitives = olx_json_member(gltf->meshes.elements[i], "primitives"), *primitive = NULL;
    if (!cJSON_IsArray(primitives)) return olx_gltf_fail(gltf, "meshes", i, "it has no primitives");
    cJSON_ArrayForEach(primitive, primitives) OLX_TRY(check_primitive(gltf, i, primitive));
  }
  return OLX_OK;
}

static uint64_t vertex_count(const olx_gltf *gltf, const cJSON *primitive) {
  const uint32_t positions = find_attribute(gltf, primitive, "POSITION");
  return positions == OLX_GLTF_NONE ? 0 : gltf->accessor_data[positions].count;
}

uint64_t olx_gltf_mesh_triangles(const olx_gltf *gltf, uint32_t mesh) {
  const cJSON *primitive = NULL;
  uint64_t all = 0;
  cJSON_ArrayForEach(primitive, olx_json_member(gltf->meshes.elements[mesh], "primitives")) {
    const uint64_t corners = corner_count(gltf, primitive), vertices = vertex_count(gltf, primitive) / 3;
    uint64_t mode;
    olx_json_size(primitive, "mode", MODE_TRIANGLES, &mode);
    const uint64_t triangles = mode > MODE_TRIANGLES && corners > 2 ? corners - 2 : corners / 3;
    const uint64_t cost = triangles > vertices ? triangles : vertices;
    all += cost ? cost : 1;
  }
  return all;
}

// ---- Triangles

// The primitive that is being read, in the form that olx_scene_append_mesh takes.
typedef struct primitive_reader {
  const olx_gltf *gltf;
  const cJSON *primitive;
  const olx_gltf_surface *surface;
  const olx_gltf_pose *pose;
  olx_affine *places; // transform of each vertex that follows joints; NULL: all have that of the pose
  float side;         // -1: the vertices are mirrored
  olx_gltf_mesh_notes *notes;
  uint32_t vertices, corners;
  uint32_t *corner; // vertex of each corner
  olx_vec3 *positions, *normals;
  olx_vec2 *uvs, *second_uvs;
  olx_vec4 *colors, *tangents;
  uint32_t *indices;
  uint32_t triangles;
} primitive_reader;

static void release_reader(primitive_reader *r) {
  void *const arrays[] = {r->places,     r->corner, r->positions, r->normals, r->uvs,
                          r->second_uvs, r->colors, r->tangents,  r->indices};
  for (size_t i = 0; i < sizeof arrays / sizeof *arrays; ++i) olx_release(arrays[i]);
}

static olx_result no_memory(const primitive_reader *r) {
  return olx_fail(OLX_ERROR_MEMORY, "%s: out of memory for a mesh of %u vertices", r->gltf->path, r->vertices);
}

// Returns the accessor of an attribute; OLX_GLTF_NONE when the primitive has none that matches its positions.
static uint32_t usable_attribute(const primitive_reader *r, const char *name) {
  const uint32_t index = find_attribute(r->gltf, r->primitive, name);
  if (index == OLX_GLTF_NONE || r->gltf->accessor_data[index].count == r->vertices) return index;
  ++r->notes->lost_attributes;
  return OLX_GLTF_NONE;
}

static const olx_affine *transform_of(const primitive_reader *r, uint32_t vertex) {
  return r->places ? &r->places[vertex] : r->pose->transform;
}

// Finds how vertices are placed. Joints seldom mirror a part of a mesh, so that the first vertex counts.
static olx_result read_places(primitive_reader *r) {
  const bool skinned = r->pose->skin != NULL;
  const olx_gltf_bond bond = {skinned ? usable_attribute(r, "JOINTS_0") : OLX_GLTF_NONE,
                              skinned ? usable_attribute(r, "WEIGHTS_0") : OLX_GLTF_NONE};
  if (bond.joints != OLX_GLTF_NONE && bond.weights != OLX_GLTF_NONE) {
    r->places = olx_allocate(r->vertices, sizeof *r->places);
    if (!r->places) return no_memory(r);
    OLX_TRY(olx_gltf_pose_vertices(r->gltf, r->pose->skin, &bond, r->vertices, r->places, &r->notes->unweighted));
  } else if (skinned) {
    r->notes->unweighted += r->vertices;
  }
  r->side = olx_affine_determinant(transform_of(r, 0)) < 0.0 ? -1.0f : 1.0f;
  return OLX_OK;
}

static olx_result read_positions(primitive_reader *r) {
  const uint32_t index = find_attribute(r->gltf, r->primitive, "POSITION");
  r->positions = olx_allocate(r->vertices, sizeof *r->positions);
  if (!r->positions) return no_memory(r);
  OLX_TRY(olx_gltf_read_floats(r->gltf, index, 3, &r->positions[0].x));
  float farthest = 0.0f;
  for (uint32_t i = 0; i < r->vertices; ++i) {
    const olx_vec3 p = r->positions[i];
    farthest = olx_max(farthest, olx_max3(olx_v3(fabsf(p.x), fabsf(p.y), fabsf(p.z))));
    r->positions[i] = olx_affine_point(transform_of(r, i), p);
  }
  if (r->gltf->accessor_data[index].type == OLX_GLTF_FLOAT) {
    olx_note_farthest(&r->notes->model, farthest, transform_of(r, 0));
  }
  return OLX_OK;
}

static olx_result read_normals(primitive_reader *r) {
  const uint32_t index = usable_attribute(r, "NORMAL");
  if (index == OLX_GLTF_NONE) return OLX_OK;
  r->normals = olx_allocate(r->vertices, sizeof *r->normals);
  if (!r->normals) return no_memory(r);
  OLX_TRY(olx_gltf_read_floats(r->gltf, index, 3, &r->normals[0].x));
  olx_affine cofactors = olx_affine_normals(r->pose->transform);
  for (uint32_t i = 0; i < r->vertices; ++i) {
    if (r->places) cofactors = olx_affine_normals(&r->places[i]);
    r->normals[i] = olx_scale(olx_affine_vector(&cofactors, olx_normalize(r->normals[i])), r->side);
  }
  return OLX_OK;
}

// Reads tangents, which are used only with a normal map and normals.
static olx_result read_tangents(primitive_reader *r) {
  const olx_material *m = &r->gltf->scene->materials[r->surface->material];
  const uint32_t index =
      r->normals && m->normal_texture != OLX_NO_TEXTURE ? usable_attribute(r, "TANGENT") : OLX_GLTF_NONE;
  if (index == OLX_GLTF_NONE) return OLX_OK;
  r->tangents = olx_allocate(r->vertices, sizeof *r->tangents);
  if (!r->tangents) return no_memory(r);
  OLX_TRY(olx_gltf_read_floats(r->gltf, index, 4, &r->tangents[0].x));
  for (uint32_t i = 0; i < r->vertices; ++i) {
    const olx_vec4 t = r->tangents[i];
    const olx_vec3 turned = olx_normalize(olx_affine_vector(transform_of(r, i), olx_normalize(olx_v3(t.x, t.y, t.z))));
    const bool usable = olx_finite(turned) && olx_length(turned) > 0.5f;
    r->tangents[i] = usable ? (olx_vec4){turned.x, turned.y, turned.z, t.w < 0.0f ? -r->side : r->side} : (olx_vec4){0};
  }
  return OLX_OK;
}

static olx_result read_uvs(primitive_reader *r, uint32_t place, olx_vec2 **uvs) {
  if (place >= r->surface->placements.count) return OLX_OK;
  const olx_gltf_placement *placement = &r->surface->placements.places[place];
  char name[32];
  snprintf(name, sizeof name, "TEXCOORD_%u", placement->set);
  const uint32_t index = usable_attribute(r, name);
  if (index == OLX_GLTF_NONE && place == 0) return OLX_OK;
  *uvs = olx_allocate_zero(r->vertices, sizeof **uvs);
  if (!*uvs) return no_memory(r);
  if (index == OLX_GLTF_NONE) return OLX_OK;
  OLX_TRY(olx_gltf_read_floats(r->gltf, index, 2, &(*uvs)[0].x));
  for (uint32_t i = 0; i < r->vertices; ++i) (*uvs)[i] = olx_gltf_place_uv(placement, (*uvs)[i]);
  return OLX_OK;
}

static float clamp_share(float x) { return x >= 0.0f && x <= 1.0f ? x : x > 1.0f ? 1.0f : 0.0f; }

// Reads colours; vertices that are all white are treated as having none.
static olx_result read_colors(primitive_reader *r) {
  const uint32_t index = usable_attribute(r, "COLOR_0");
  if (index == OLX_GLTF_NONE) return OLX_OK;
  r->colors = olx_allocate(r->vertices, sizeof *r->colors);
  if (!r->colors) return no_memory(r);
  for (uint32_t i = 0; i < r->vertices; ++i) r->colors[i].w = 1.0f;
  OLX_TRY(olx_gltf_read_floats(r->gltf, index, 4, &r->colors[0].x));
  bool white = true;
  for (uint32_t i = 0; i < r->vertices; ++i) {
    olx_vec4 *c = &r->colors[i];
    *c = (olx_vec4){clamp_share(c->x), clamp_share(c->y), clamp_share(c->z), clamp_share(c->w)};
    white = white && c->x >= 1.0f && c->y >= 1.0f && c->z >= 1.0f && c->w >= 1.0f;
  }
  if (!white) return OLX_OK;
  olx_release(r->colors);
  r->colors = NULL;
  return OLX_OK;
}

static olx_result read_corners(primitive_reader *r) {
  uint32_t index;
  olx_gltf_index(r->primitive, "indices", r->gltf->accessors.count, &index);
  r->corners = (uint32_t)corner_count(r->gltf, r->primitive);
  r->corner = olx_allocate(r->corners, sizeof *r->corner);
  if (!r->corner) return no_memory(r);
  if (index != OLX_GLTF_NONE) return olx_gltf_read_indices(r->gltf, index, r->corner);
  for (uint32_t i = 0; i < r->corners; ++i) r->corner[i] = i;
  return OLX_OK;
}

// Finds the corners of triangle t: every other triangle of a strip is reversed, and all triangles of a fan share the
// first corner.
static void find_corners(uint64_t mode, uint32_t t, uint32_t places[3]) {
  const uint32_t first = mode == MODE_TRIANGLES ? 3 * t : mode == MODE_STRIP ? t : 0;
  const uint32_t odd = mode == MODE_STRIP ? t & 1 : 0, step = mode == MODE_FAN ? t : 0;
  places[0] = first;
  places[1] = first + 1 + step + odd;
  places[2] = first + 2 + step - odd;
}

// Builds the triangles. A mirroring transform reverses them, so that front faces stay front faces.
static olx_result make_triangles(primitive_reader *r) {
  uint64_t mode;
  olx_json_size(r->primitive, "mode", MODE_TRIANGLES, &mode);
  r->triangles = mode == MODE_TRIANGLES ? r->corners / 3 : r->corners - 2;
  r->indices = olx_allocate(r->triangles, 3 * sizeof *r->indices);
  if (!r->indices) return no_memory(r);
  const bool mirrored = r->side < 0.0f;
  for (uint32_t t = 0; t < r->triangles; ++t) {
    uint32_t places[3], *index = r->indices + (size_t)t * 3;
    find_corners(mode, t, places);
    index[0] = r->corner[places[0]];
    index[1] = r->corner[places[mirrored ? 2 : 1]];
    index[2] = r->corner[places[mirrored ? 1 : 2]];
  }
  return OLX_OK;
}

static olx_result read_primitive(primitive_reader *r) {
  OLX_TRY(olx_gltf_decode_draco(r->gltf, r->primitive));
  r->vertices = (uint32_t)vertex_count(r->gltf, r->primitive);
  OLX_TRY(read_places(r));
  OLX_TRY(read_positions(r));
  OLX_TRY(read_normals(r));
  OLX_TRY(read_tangents(r));
  OLX_TRY(read_uvs(r, 0, &r->uvs));
  OLX_TRY(read_uvs(r, 1, &r->second_uvs));
  OLX_TRY(read_colors(r));
  OLX_TRY(read_corners(r));
  return make_triangles(r);
}

static void name_mesh(const olx_gltf *gltf, uint32_t mesh, char *name, size_t size_bytes) {
  const char *own = olx_json_text(gltf->meshes.elements[mesh], "name");
  if (own[0]) snprintf(name, size_bytes, "%.1024s: mesh \"%.100s\"", gltf->path, own);
  else snprintf(name, size_bytes, "%.1024s: meshes[%u]", gltf->path, mesh);
}

static olx_result append_primitive(const primitive_reader *r, uint32_t mesh) {
  const olx_mesh appended = {.positions = r->positions,
                             .normals = r->normals,
                             .uvs = r->uvs,
                             .second_uvs = r->second_uvs,
                             .colors = r->colors,
                             .tangents = r->tangents,
                             .indices = r->indices,
                             .vertex_count = r->vertices,
                             .triangle_count = r->triangles,
                             .material = r->surface->material};
  char name[1200];
  name_mesh(r->gltf, mesh, name, sizeof name);
  return olx_scene_append_mesh(r->gltf->scene, name, &appended);
}

// Returns whether a primitive has visible triangles; fully transparent ones are counted.
static bool has_triangles(const olx_gltf *gltf, const cJSON *primitive, const olx_gltf_surface *surface,
                          olx_model_notes *notes) {
  const uint64_t corners = corner_count(gltf, primitive);
  uint64_t mode;
  olx_json_size(primitive, "mode", MODE_TRIANGLES, &mode);
  if (find_attribute(gltf, primitive, "POSITION") == OLX_GLTF_NONE) return false;
  if (mode < MODE_TRIANGLES) {
    notes->thin_faces += mode == MODE_LINES ? corners / 2 : mode == MODE_LINE_STRIP ? corners - 1 : corners;
    return false;
  }
  if (surface->absent) notes->absent_triangles += mode == MODE_TRIANGLES ? corners / 3 : corners - 2;
  return !surface->absent;
}

static olx_result add_primitive(const olx_gltf *gltf, uint32_t mesh, const cJSON *primitive,
                                const olx_gltf_surface *surfaces, const olx_gltf_pose *pose,
                                olx_gltf_mesh_notes *notes) {
  uint32_t material;
  olx_gltf_index(primitive, "material", gltf->materials.count, &material);
  const olx_gltf_surface *surface = &surfaces[material == OLX_GLTF_NONE ? gltf->materials.count : material];
  if (!has_triangles(gltf, primitive, surface, &notes->model)) return OLX_OK;
  primitive_reader reader = {.gltf = gltf, .primitive = primitive, .surface = surface, .pose = pose, .notes = notes};
  olx_result result = read_primitive(&reader);
  if (result == OLX_OK) result = append_primitive(&reader, mesh);
  release_reader(&reader);
  return result;
}

olx_result olx_gltf_add_mesh(const olx_gltf *gltf, uint32_t mesh, const olx_gltf_surface *surfaces,
                             const olx_gltf_pose *pose, olx_gltf_mesh_notes *notes) {
  const cJSON *primitive = NULL;
  bool morphed = false;
  cJSON_ArrayForEach(primitive, olx_json_member(gltf->meshes.elements[mesh], "primitives")) {
    OLX_TRY(add_primitive(gltf, mesh, primitive, surfaces, pose, notes));
    morphed |= cJSON_GetArraySize(olx_json_member(primitive, "targets")) > 0;
  }
  notes->morphed += morphed;
  return OLX_OK;
}
