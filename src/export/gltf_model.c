// Writes a field as a glTF model: octahedra at the probes, and the edges of the boxes into which space is divided.
#include "core/file.h"
#include "core/hooks.h"
#include "core/result.h"
#include "export/gltf_boxes.h"

#include <octalux/export.h>

#include <cjson/cJSON.h>
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

// glTF's constants, which are OpenGL's.
enum {
  FLOAT = 5126,
  UNSIGNED_INT = 5125,
  ARRAY_BUFFER = 34962,
  ELEMENT_ARRAY_BUFFER = 34963,
  LINES = 1,
  TRIANGLES = 4
};

enum { CORNERS = 6, FACES = 8, BOX_CORNERS = 8, BOX_ENDS = 24 };

typedef enum model_material {
  MATERIAL_PROBE,
  MATERIAL_BURIED,
  MATERIAL_IRRADIANCE,
  MATERIAL_VOLUME,
  MATERIAL_CELL,
  MATERIAL_BRICK,
  MATERIAL_DIVIDED,
  MATERIAL_COUNT
} model_material;

// Sizes of octahedra, in diagonals of the scene.
static const float PROBE_RADIUS = 0.01f, IRRADIANCE_RADIUS = 0.006f, VOLUME_RADIUS = 0.003f;

typedef struct gltf_model {
  const olx_field *field;
  cJSON *root, *nodes, *meshes, *accessors, *views;
  uint32_t node_count; // of `nodes`, which is too long to be counted again and again
  uint8_t *bytes;      // of the buffer
  size_t size_bytes, most_bytes;
  bool failed; // out of memory
  olx_gltf_counts counts;
} gltf_model;

// ---- JSON

static cJSON *new_object(gltf_model *m, cJSON *list) {
  cJSON *object = cJSON_CreateObject();
  if (!object || !cJSON_AddItemToArray(list, object)) m->failed = true;
  return object;
}

static void add_vector(cJSON *object, const char *key, olx_vec3 v) {
  const float numbers[3] = {v.x, v.y, v.z};
  cJSON_AddItemToObject(object, key, cJSON_CreateFloatArray(numbers, 3));
}

static uint32_t size_of(const cJSON *list) { return (uint32_t)cJSON_GetArraySize(list); }

// Adds a node to the children of a parent.
static cJSON *add_node(gltf_model *m, cJSON *children, const char *name) {
  cJSON_AddItemToArray(children, cJSON_CreateNumber(m->node_count++));
  cJSON *node = new_object(m, m->nodes);
  cJSON_AddStringToObject(node, "name", name);
  return node;
}

// Adds a node that groups others; returns the list of its children.
static cJSON *add_group(gltf_model *m, cJSON *children, const char *name) {
  return cJSON_AddArrayToObject(add_node(m, children, name), "children");
}

// ---- Buffer

// Reserves bytes at the end of the buffer; NULL when memory runs out.
static void *extend(gltf_model *m, size_t size_bytes) {
  if (m->size_bytes + size_bytes > m->most_bytes) {
    const size_t most = 2 * (m->size_bytes + size_bytes);
    uint8_t *bytes = olx_allocate(most, 1);
    if (!bytes) {
      m->failed = true;
      return NULL;
    }
    if (m->size_bytes) memcpy(bytes, m->bytes, m->size_bytes);
    olx_release(m->bytes);
    m->bytes = bytes;
    m->most_bytes = most;
  }
  void *end = m->bytes + m->size_bytes;
  m->size_bytes += size_bytes;
  return end;
}

// Adds an accessor, with its own view, over the last `count` elements of the buffer; returns its index.
static uint32_t add_accessor(gltf_model *m, uint32_t count, const char *type, int component, int target,
                             size_t element_bytes) {
  const size_t bytes = count * element_bytes;
  cJSON *view = new_object(m, m->views);
  cJSON_AddNumberToObject(view, "buffer", 0);
  cJSON_AddNumberToObject(view, "byteOffset", (double)(m->size_bytes - bytes));
  cJSON_AddNumberToObject(view, "byteLength", (double)bytes);
  cJSON_AddNumberToObject(view, "target", target);
  cJSON *accessor = new_object(m, m->accessors);
  cJSON_AddNumberToObject(accessor, "bufferView", size_of(m->views) - 1);
  cJSON_AddNumberToObject(accessor, "componentType", component);
  cJSON_AddNumberToObject(accessor, "count", count);
  cJSON_AddStringToObject(accessor, "type", type);
  return size_of(m->accessors) - 1;
}

// Adds an accessor of positions with bounds, which glTF requires.
static uint32_t add_positions(gltf_model *m, const olx_vec3 *positions, uint32_t count) {
  olx_vec3 low = positions[0], high = positions[0];
  for (uint32_t i = 1; i < count; i++) {
    low = olx_min_each(low, positions[i]);
    high = olx_max_each(high, positions[i]);
  }
  const uint32_t index = add_accessor(m, count, "VEC3", FLOAT, ARRAY_BUFFER, sizeof *positions);
  cJSON *accessor = cJSON_GetArrayItem(m->accessors, (int)index);
  add_vector(accessor, "min", low);
  add_vector(accessor, "max", high);
  return index;
}

// Adds a mesh of one primitive; returns its index. `colors` is an accessor's index, or UINT32_MAX.
static uint32_t add_mesh(gltf_model *m, const char *name, uint32_t positions, uint32_t colors, uint32_t indices,
                         int mode, model_material material) {
  cJSON *mesh = new_object(m, m->meshes);
  cJSON_AddStringToObject(mesh, "name", name);
  cJSON *primitive = new_object(m, cJSON_AddArrayToObject(mesh, "primitives"));
  cJSON *attributes = cJSON_AddObjectToObject(primitive, "attributes");
  cJSON_AddNumberToObject(attributes, "POSITION", positions);
  if (colors != UINT32_MAX) cJSON_AddNumberToObject(attributes, "COLOR_0", colors);
  cJSON_AddNumberToObject(primitive, "indices", indices);
  cJSON_AddNumberToObject(primitive, "mode", mode);
  cJSON_AddNumberToObject(primitive, "material", material);
  return size_of(m->meshes) - 1;
}

// ---- Octahedra

static const olx_vec3 corners[CORNERS] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
static const uint32_t faces[FACES][3] = {{0, 2, 4}, {4, 2, 1}, {1, 2, 5}, {5, 2, 0},
                                         {0, 4, 3}, {4, 1, 3}, {1, 5, 3}, {5, 0, 3}};

// Adds positions and indices of octahedra at these positions; returns the accessor of positions, and *indices receives
// that of the indices.
static uint32_t add_octahedra(gltf_model *m, const olx_vec3 *places, uint32_t count, float radius, uint32_t *indices) {
  olx_vec3 *positions = extend(m, (size_t)count * sizeof corners);
  if (!positions) return 0;
  for (uint32_t i = 0; i < count * CORNERS; i++) {
    positions[i] = olx_madd(places[i / CORNERS], corners[i % CORNERS], radius);
  }
  const uint32_t accessor = add_positions(m, positions, count * CORNERS);
  uint32_t *numbers = extend(m, (size_t)count * sizeof faces);
  if (!numbers) return 0;
  for (uint32_t i = 0; i < count * FACES * 3; i++) {
    numbers[i] = i / (FACES * 3) * CORNERS + faces[i / 3 % FACES][i % 3];
  }
  *indices = add_accessor(m, count * FACES * 3, "SCALAR", UNSIGNED_INT, ELEMENT_ARRAY_BUFFER, sizeof *numbers);
  return accessor;
}

// Adds the two meshes that the probes of a kind share, one in each colour: the second is for buried probes (inside
// geometry).
static uint32_t add_probe_meshes(gltf_model *m, const char *name, float radius, model_material material) {
  static const olx_vec3 middle = {0, 0, 0};
  uint32_t indices = 0;
  const uint32_t positions = add_octahedra(m, &middle, 1, radius, &indices);
  const uint32_t mesh = add_mesh(m, name, positions, UINT32_MAX, indices, TRIANGLES, material);
  add_mesh(m, "inside geometry", positions, UINT32_MAX, indices, TRIANGLES, MATERIAL_BURIED);
  return mesh;
}

static void add_probes(gltf_model *m, cJSON *children, const char *kind, const olx_vec3 *positions,
                       const uint8_t *flags, uint32_t count, uint32_t mesh) {
  char name[64];
  for (uint32_t i = 0; i < count; i++) {
    const bool buried = (flags[i] & OLX_PROBE_BURIED) != 0;
    snprintf(name, sizeof name, "%s %u", kind, i);
    cJSON *node = add_node(m, children, name);
    add_vector(node, "translation", positions[i]);
    cJSON_AddNumberToObject(node, "mesh", mesh + (buried ? 1 : 0));
    cJSON *extras = cJSON_AddObjectToObject(node, "extras");
    cJSON_AddNumberToObject(extras, "probe", i);
    cJSON_AddBoolToObject(extras, "buried", buried);
  }
}

static float diagonal(const olx_field *f) {
  return olx_length(olx_sub(f->info.scene.bounds_max, f->info.scene.bounds_min));
}

static void add_light_field_probes(gltf_model *m, cJSON *children) {
  const olx_field *f = m->field;
  const uint32_t mesh = add_probe_meshes(m, "light field probe", PROBE_RADIUS * diagonal(f), MATERIAL_PROBE);
  add_probes(m, add_group(m, children, "light field probes"), "light field probe", f->probe_positions, f->probe_flags,
             f->info.probes.count, mesh);
  m->counts.probes = f->info.probes.count;
}

static void add_irradiance_probes(gltf_model *m, cJSON *children) {
  const olx_field *f = m->field;
  if (!f->info.irradiance.probe_count) return;
  const uint32_t mesh = add_probe_meshes(m, "irradiance probe", IRRADIANCE_RADIUS * diagonal(f), MATERIAL_IRRADIANCE);
  add_probes(m, add_group(m, children, "irradiance probes"), "irradiance probe", f->irradiance_positions,
             f->irradiance_flags, f->info.irradiance.probe_count, mesh);
  m->counts.irradiance_probes = f->info.irradiance.probe_count;
}

// ---- Boxes

static const uint8_t box_ends[BOX_ENDS] = {0, 1, 2, 3, 4, 5, 6, 7, 0, 2, 1, 3, 4, 6, 5, 7, 0, 4, 1, 5, 2, 6, 3, 7};

static void add_box_edges(gltf_model *m, cJSON *children, const char *name, const olx_export_boxes *boxes,
                          model_material material) {
  if (!boxes->count) return;
  olx_vec3 *positions = extend(m, (size_t)boxes->count * BOX_CORNERS * sizeof *positions);
  if (!positions) return;
  for (uint32_t i = 0; i < boxes->count * BOX_CORNERS; i++) {
    const olx_export_box *box = &boxes->boxes[i / BOX_CORNERS];
    const olx_vec3 corner = {(float)(i & 1), (float)(i >> 1 & 1), (float)(i >> 2 & 1)};
    positions[i] = olx_madd(box->low, corner, box->side);
  }
  const uint32_t accessor = add_positions(m, positions, boxes->count * BOX_CORNERS);
  uint32_t *ends = extend(m, (size_t)boxes->count * BOX_ENDS * sizeof *ends);
  if (!ends) return;
  for (uint32_t i = 0; i < boxes->count * BOX_ENDS; i++) ends[i] = i / BOX_ENDS * BOX_CORNERS + box_ends[i % BOX_ENDS];
  const uint32_t indices =
      add_accessor(m, boxes->count * BOX_ENDS, "SCALAR", UNSIGNED_INT, ELEMENT_ARRAY_BUFFER, sizeof *ends);
  cJSON_AddNumberToObject(add_node(m, children, name), "mesh",
                          add_mesh(m, name, accessor, UINT32_MAX, indices, LINES, material));
}

static void add_volume_probes(gltf_model *m, cJSON *children) {
  const olx_field *f = m->field;
  const uint32_t count = f->info.volume.probe_count;
  uint32_t indices = 0;
  const uint32_t positions = add_octahedra(m, f->volume.positions, count, VOLUME_RADIUS * diagonal(f), &indices);
  olx_vec3 *colors = extend(m, (size_t)count * CORNERS * sizeof *colors);
  if (!colors) return;
  for (uint32_t i = 0; i < count * CORNERS; i++) {
    const uint16_t *halves = f->volume.irradiance + (size_t)OLX_VOLUME_HALVES * (i / CORNERS);
    const olx_vec3 mean = olx_scale(olx_harmonics_coefficient(halves, 0), 1.0f / OLX_PI);
    colors[i] = olx_min_each(olx_max_each(mean, olx_splat(0.0f)), olx_splat(1.0f));
  }
  const uint32_t accessor = add_accessor(m, count * CORNERS, "VEC3", FLOAT, ARRAY_BUFFER, sizeof *colors);
  const uint32_t mesh = add_mesh(m, "probes of the volume", positions, accessor, indices, TRIANGLES, MATERIAL_VOLUME);
  cJSON_AddNumberToObject(add_node(m, children, "probes of the volume"), "mesh", mesh);
  m->counts.volume_probes = count;
}

static void add_volume(gltf_model *m, cJSON *children) {
  if (!m->field->info.volume.probe_count) return;
  cJSON *group = add_group(m, children, "irradiance volume");
  olx_export_boxes cells = {0};
  add_volume_probes(m, group);
  if (!olx_export_volume_cells(m->field, &cells)) m->failed = true;
  add_box_edges(m, group, "cells of the volume", &cells, MATERIAL_CELL);
  m->counts.volume_cells = cells.count;
  olx_release(cells.boxes);
}

static void add_bricks(gltf_model *m, cJSON *children) {
  olx_export_boxes whole = {0}, divided = {0};
  if (!olx_export_bricks(m->field, false, &whole) || !olx_export_bricks(m->field, true, &divided)) m->failed = true;
  if (whole.count || divided.count) {
    cJSON *group = add_group(m, children, "bricks");
    add_box_edges(m, group, "whole bricks", &whole, MATERIAL_BRICK);
    add_box_edges(m, group, "divided bricks", &divided, MATERIAL_DIVIDED);
  }
  m->counts.bricks = whole.count;
  m->counts.divided_bricks = divided.count;
  olx_release(whole.boxes);
  olx_release(divided.boxes);
}

// ---- The file

// Adds unlit materials; tools without the extension show them as rough surfaces.
static void add_materials(gltf_model *m) {
  static const struct {
    const char *name;
    olx_vec3 color;
  } materials[MATERIAL_COUNT] = {
      [MATERIAL_PROBE] = {"light field probe", {1.0f, 0.6f, 0.05f}},
      [MATERIAL_BURIED] = {"probe inside geometry", {0.8f, 0.02f, 0.02f}},
      [MATERIAL_IRRADIANCE] = {"irradiance probe", {0.1f, 0.4f, 1.0f}},
      [MATERIAL_VOLUME] = {"probe of the irradiance volume", {1.0f, 1.0f, 1.0f}},
      [MATERIAL_CELL] = {"cell of the irradiance volume", {0.05f, 0.5f, 0.2f}},
      [MATERIAL_BRICK] = {"whole brick", {0.2f, 0.2f, 0.2f}},
      [MATERIAL_DIVIDED] = {"divided brick", {0.5f, 0.1f, 0.5f}},
  };
  cJSON *list = cJSON_AddArrayToObject(m->root, "materials");
  for (uint32_t i = 0; i < MATERIAL_COUNT; i++) {
    const olx_vec3 c = materials[i].color;
    cJSON *material = new_object(m, list);
    cJSON_AddStringToObject(material, "name", materials[i].name);
    cJSON *surface = cJSON_AddObjectToObject(material, "pbrMetallicRoughness");
    cJSON_AddItemToObject(surface, "baseColorFactor", cJSON_CreateFloatArray((float[]){c.x, c.y, c.z, 1.0f}, 4));
    cJSON_AddNumberToObject(surface, "metallicFactor", 0);
    cJSON_AddObjectToObject(cJSON_AddObjectToObject(material, "extensions"), "KHR_materials_unlit");
  }
  const char *const unlit = "KHR_materials_unlit";
  cJSON_AddItemToObject(m->root, "extensionsUsed", cJSON_CreateStringArray(&unlit, 1));
}

static void add_root(gltf_model *m) {
  char hash[24];
  snprintf(hash, sizeof hash, "%016" PRIx64, m->field->info.scene.hash);
  cJSON *asset = cJSON_AddObjectToObject(m->root, "asset");
  cJSON_AddStringToObject(asset, "version", "2.0");
  cJSON_AddStringToObject(asset, "generator", "octalux");
  cJSON_AddNumberToObject(m->root, "scene", 0);
  cJSON *scene = new_object(m, cJSON_AddArrayToObject(m->root, "scenes"));
  cJSON *scene_nodes = cJSON_AddArrayToObject(scene, "nodes");
  m->nodes = cJSON_AddArrayToObject(m->root, "nodes");
  m->meshes = cJSON_AddArrayToObject(m->root, "meshes");
  m->accessors = cJSON_AddArrayToObject(m->root, "accessors");
  m->views = cJSON_AddArrayToObject(m->root, "bufferViews");
  cJSON *node = add_node(m, scene_nodes, "field");
  cJSON_AddItemToObject(node, "translation", cJSON_CreateDoubleArray(m->field->origin, 3));
  cJSON_AddStringToObject(cJSON_AddObjectToObject(node, "extras"), "scene_hash", hash);
  cJSON *children = cJSON_AddArrayToObject(node, "children");
  add_light_field_probes(m, children);
  add_irradiance_probes(m, children);
  add_volume(m, children);
  add_bricks(m, children);
}

// Encodes bytes as Base64, four characters for three bytes.
static void encode_base64(const uint8_t *bytes, size_t size_bytes, char *text) {
  static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  for (size_t i = 0; i < size_bytes; i += 3) {
    const size_t left = size_bytes - i;
    const uint32_t word = (uint32_t)bytes[i] << 16 | (left > 1 ? (uint32_t)bytes[i + 1] << 8 : 0) |
                          (left > 2 ? (uint32_t)bytes[i + 2] : 0);
    for (uint32_t k = 0; k < 4; k++) *text++ = k <= left ? digits[word >> (18 - 6 * k) & 63u] : '=';
  }
  *text = 0;
}

static void add_buffer(gltf_model *m) {
  static const char prefix[] = "data:application/octet-stream;base64,";
  char *text = olx_allocate(sizeof prefix + (m->size_bytes + 2) / 3 * 4, 1);
  if (!text) {
    m->failed = true;
    return;
  }
  memcpy(text, prefix, sizeof prefix);
  encode_base64(m->bytes, m->size_bytes, text + sizeof prefix - 1);
  cJSON *buffer = new_object(m, cJSON_AddArrayToObject(m->root, "buffers"));
  cJSON_AddNumberToObject(buffer, "byteLength", (double)m->size_bytes);
  if (!cJSON_AddStringToObject(buffer, "uri", text)) m->failed = true;
  olx_release(text);
}

static olx_result write_model(gltf_model *m, const char *path) {
  char *text = m->failed ? NULL : cJSON_PrintUnformatted(m->root);
  if (!text) return olx_fail(OLX_ERROR_MEMORY, "%s: out of memory", path);
  const olx_result result = olx_write_file(path, text, strlen(text));
  cJSON_free(text);
  return result;
}

olx_result olx_export_gltf(const olx_field *field, const char *path, olx_gltf_counts *counts) {
  gltf_model m = {.field = field, .root = cJSON_CreateObject()};
  if (!m.root) return olx_fail(OLX_ERROR_MEMORY, "%s: out of memory", path);
  add_root(&m);
  add_materials(&m);
  add_buffer(&m);
  const olx_result result = write_model(&m, path);
  cJSON_Delete(m.root);
  olx_release(m.bytes);
  if (counts) *counts = m.counts;
  return result;
}
