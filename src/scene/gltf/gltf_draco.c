// Finds which accessors are compressed by Draco, checks them against what their stream's header claims, and decodes a
// primitive's stream into its accessors.
#include "scene/gltf/gltf_draco.h"

#include "core/hooks.h"
#include "core/result.h"
#include "scene/gltf/draco_mesh.h"
#include "scene/gltf/gltf_accessor.h"
#include "scene/gltf/gltf_buffer.h"

// ---- A primitive

// Returns the accessor that a member of an object names; NULL when it names none that exists.
static olx_gltf_accessor *accessor_of(const olx_gltf *gltf, const cJSON *object, const char *key) {
  uint32_t index;
  if (!olx_gltf_index(object, key, gltf->accessors.count, &index) || index == OLX_GLTF_NONE) return NULL;
  return &gltf->accessor_data[index];
}

static olx_gltf_accessor *attribute_of(const olx_gltf *gltf, const cJSON *primitive, const char *name) {
  return accessor_of(gltf, olx_json_member(primitive, "attributes"), name);
}

static uint32_t number_of(const olx_gltf *gltf, const olx_gltf_accessor *a) {
  return (uint32_t)(a - gltf->accessor_data);
}

// Returns the extension of a primitive that is to be decoded; NULL of one that has none, or has its uncompressed form
// as well.
static const cJSON *compression_of(const olx_gltf *gltf, const cJSON *primitive) {
  const olx_gltf_accessor *positions = attribute_of(gltf, primitive, "POSITION");
  if (!positions || olx_json_member(gltf->accessors.elements[number_of(gltf, positions)], "bufferView")) return NULL;
  return olx_gltf_extension(primitive, "KHR_draco_mesh_compression");
}

static uint32_t view_of(const olx_gltf *gltf, const cJSON *compression) {
  uint32_t view;
  return olx_gltf_index(compression, "bufferView", gltf->views.count, &view) ? view : OLX_GLTF_NONE;
}

// ---- Marks

static void mark(olx_gltf_accessor *a) {
  if (a) a->compressed = true;
}

static void mark_primitive(olx_gltf *gltf, const cJSON *primitive) {
  const cJSON *compression = compression_of(gltf, primitive), *id = NULL;
  if (!compression) return;
  cJSON_ArrayForEach(id, olx_json_member(compression, "attributes")) mark(attribute_of(gltf, primitive, id->string));
  mark(accessor_of(gltf, primitive, "indices"));
}

void olx_gltf_mark_draco(olx_gltf *gltf) {
  for (uint32_t i = 0; i < gltf->meshes.count; ++i) {
    const cJSON *primitive = NULL;
    cJSON_ArrayForEach(primitive, olx_json_member(gltf->meshes.elements[i], "primitives")) {
      mark_primitive(gltf, primitive);
    }
  }
}

// ---- Checks

// Returns whether a primitive names a compressed accessor that its own stream has no elements for.
static bool lacks_elements(const olx_gltf *gltf, const cJSON *primitive, const cJSON *compression) {
  const cJSON *ids = olx_json_member(compression, "attributes"), *attribute = NULL;
  const olx_gltf_accessor *indices = accessor_of(gltf, primitive, "indices");
  if (indices && indices->compressed && !compression) return true;
  cJSON_ArrayForEach(attribute, olx_json_member(primitive, "attributes")) {
    const olx_gltf_accessor *a = attribute_of(gltf, primitive, attribute->string);
    if (a && a->compressed && !olx_json_member(ids, attribute->string)) return true;
  }
  return false;
}

static const char *find_wrong_attribute(const olx_gltf *gltf, const cJSON *primitive, const cJSON *compression) {
  const cJSON *ids = olx_json_member(compression, "attributes"), *id = NULL;
  if (!olx_json_member(ids, "POSITION")) return "its Draco compression has no positions";
  cJSON_ArrayForEach(id, ids) {
    uint64_t number;
    if (!attribute_of(gltf, primitive, id->string)) {
      return "its Draco compression names an attribute that it does not have";
    }
    if (!olx_json_size(ids, id->string, 0, &number) || number > UINT32_MAX) {
      return "its Draco compression names an attribute by something else than a number";
    }
  }
  return NULL;
}

static const char *find_wrong_stream(const olx_gltf *gltf, const cJSON *primitive, const cJSON *compression) {
  const uint32_t view = view_of(gltf, compression);
  const olx_gltf_accessor *indices = accessor_of(gltf, primitive, "indices");
  olx_draco_header header;
  if (view == OLX_GLTF_NONE) return "the bufferView of its Draco compression does not exist";
  if (gltf->view_data[view].compressed) return "its Draco stream is compressed by meshopt as well";
  const olx_gltf_bytes stream = gltf->view_data[view].bytes;
  const char *problem = olx_draco_read_header(stream.data, stream.size_bytes, &header);
  if (problem) return problem;
  const bool fits = indices && header.faces > 0 && indices->count >= 3 * (uint64_t)header.faces &&
                    attribute_of(gltf, primitive, "POSITION")->count <= header.most_points;
  return fits ? NULL : "its Draco stream has other numbers of triangles or points than its accessors";
}

static const char *find_problem(const olx_gltf *gltf, const cJSON *primitive) {
  const cJSON *compression = compression_of(gltf, primitive);
  uint64_t mode;
  if (lacks_elements(gltf, primitive, compression))
    return "elements of it are only in another primitive's Draco stream";
  if (!compression) return NULL;
  if (!olx_json_size(primitive, "mode", 4, &mode) || mode != 4) {
    return "it has Draco compression and is not made of separate triangles";
  }
  const char *problem = find_wrong_attribute(gltf, primitive, compression);
  return problem ? problem : find_wrong_stream(gltf, primitive, compression);
}

olx_result olx_gltf_check_draco(const olx_gltf *gltf, uint32_t mesh, const cJSON *primitive) {
  const char *problem = find_problem(gltf, primitive);
  return problem ? olx_gltf_fail(gltf, "meshes", mesh, problem) : OLX_OK;
}

// ---- Decoding

// Makes room for the elements of a primitive. The stream's number of them replaces the accessor's, because some writers
// (FBX2glTF) leave there what the mesh had before it was compressed. Only a number that the accessor claimed may exceed
// `most`, since memory was bounded by these two.
static olx_result make_room(const olx_gltf *gltf, const cJSON *primitive, olx_gltf_accessor *a, uint64_t count,
                            uint64_t most) {
  if (a->count != count) {
    if (count == 0 || count > most) {
      return olx_gltf_fail(gltf, "accessors", number_of(gltf, a), "a Draco stream has another number of its elements");
    }
    olx_release(a->decoded);
    a->decoded = NULL;
    a->count = count;
  }
  a->decoded_for = primitive;
  if (!a->decoded) a->decoded = olx_allocate(a->count, a->stride);
  return a->decoded ? OLX_OK : olx_fail(OLX_ERROR_MEMORY, "%s: out of memory", gltf->path);
}

static olx_result read_mesh(const olx_gltf *gltf, const cJSON *primitive, const olx_draco_mesh *mesh) {
  const cJSON *ids = olx_json_member(compression_of(gltf, primitive), "attributes"), *id = NULL;
  olx_gltf_accessor *indices = accessor_of(gltf, primitive, "indices");
  const uint64_t corners = 3 * (uint64_t)olx_draco_faces(mesh);
  cJSON_ArrayForEach(id, ids) {
    olx_gltf_accessor *a = attribute_of(gltf, primitive, id->string);
    uint64_t number;
    olx_json_size(ids, id->string, 0, &number);
    OLX_TRY(make_room(gltf, primitive, a, olx_draco_points(mesh), corners));
    if (!olx_draco_read_attribute(mesh, (uint32_t)number, (int)a->type, a->components, a->decoded)) {
      return olx_gltf_fail(gltf, "accessors", number_of(gltf, a), "a Draco stream has no such elements");
    }
  }
  OLX_TRY(make_room(gltf, primitive, indices, corners, corners));
  if (olx_draco_read_faces(mesh, (int)indices->type, indices->decoded)) return OLX_OK;
  return olx_gltf_fail(gltf, "accessors", number_of(gltf, indices), "a Draco stream has indices of more bits");
}

// Returns whether no other primitive has been decoded into one of the accessors since this one.
static bool is_decoded(const olx_gltf *gltf, const cJSON *primitive) {
  const cJSON *id = NULL;
  cJSON_ArrayForEach(id, olx_json_member(compression_of(gltf, primitive), "attributes")) {
    if (attribute_of(gltf, primitive, id->string)->decoded_for != primitive) return false;
  }
  return accessor_of(gltf, primitive, "indices")->decoded_for == primitive;
}

olx_result olx_gltf_decode_draco(const olx_gltf *gltf, const cJSON *primitive) {
  const cJSON *compression = compression_of(gltf, primitive);
  if (!compression || is_decoded(gltf, primitive)) return OLX_OK;
  const uint32_t view = view_of(gltf, compression);
  const olx_gltf_bytes stream = gltf->view_data[view].bytes;
  olx_draco_mesh *mesh = olx_draco_decode(stream.data, stream.size_bytes);
  if (!mesh) return olx_gltf_fail(gltf, "bufferViews", view, "its Draco stream cannot be decoded");
  const olx_result result = read_mesh(gltf, primitive, mesh);
  olx_draco_release(mesh);
  return result;
}
