// Reads glTF accessors. Each is checked against its view once, so that reading needs no checks except of the indices of
// sparse elements.
#include "scene/gltf/gltf_accessor.h"

#include "core/hooks.h"
#include "core/result.h"
#include "scene/gltf/gltf_buffer.h"
#include "scene/gltf/gltf_meshopt.h"

#include <math.h>
#include <string.h>

// ---- Checks

static uint64_t component_bytes(uint64_t type) {
  switch (type) {
  case OLX_GLTF_INT8:
  case OLX_GLTF_UINT8: return 1;
  case OLX_GLTF_INT16:
  case OLX_GLTF_UINT16: return 2;
  case OLX_GLTF_UINT32:
  case OLX_GLTF_FLOAT: return 4;
  default: return 0;
  }
}

static uint32_t component_count(const char *type) {
  static const char *const names[] = {"SCALAR", "VEC2", "VEC3", "VEC4", "MAT2", "MAT3", "MAT4"};
  static const uint32_t counts[] = {1, 2, 3, 4, 4, 9, 16};
  for (size_t i = 0; i < sizeof counts / sizeof *counts; ++i) {
    if (strcmp(type, names[i]) == 0) return counts[i];
  }
  return 0;
}

// Returns the size of the range that the elements of a view may occupy, in bytes.
static uint64_t view_size(const olx_gltf *gltf, uint32_t view) {
  const olx_gltf_view *found = &gltf->view_data[view];
  return found->compressed && !found->decoded ? olx_gltf_meshopt_size(found->compressed) : found->bytes.size_bytes;
}

// Finds `count` packed elements of `element_bytes` that an object's bufferView and byteOffset refer to; false when some
// lie outside the view.
static bool find_packed(const olx_gltf *gltf, const cJSON *object, uint64_t count, uint64_t element_bytes,
                        uint32_t *view, uint64_t *offset) {
  return olx_gltf_index(object, "bufferView", gltf->views.count, view) && *view != OLX_GLTF_NONE &&
         olx_json_size(object, "byteOffset", 0, offset) && *offset + count * element_bytes <= view_size(gltf, *view);
}

static olx_result read_sparse(const olx_gltf *gltf, uint32_t i, const cJSON *element, olx_gltf_accessor *a) {
  const cJSON *sparse = olx_json_member(element, "sparse");
  const cJSON *indices = olx_json_member(sparse, "indices"), *values = olx_json_member(sparse, "values");
  olx_gltf_sparse *s = &a->sparse;
  uint64_t type;
  if (!sparse) return OLX_OK;
  if (!olx_json_size(sparse, "count", 0, &s->count) || s->count == 0 || s->count > a->count) {
    return olx_gltf_fail(gltf, "accessors", i, "its sparse count is not a sensible number");
  }
  if (!olx_json_size(indices, "componentType", 0, &type) ||
      (type != OLX_GLTF_UINT8 && type != OLX_GLTF_UINT16 && type != OLX_GLTF_UINT32)) {
    return olx_gltf_fail(gltf, "accessors", i, "its sparse indices are not unsigned numbers");
  }
  s->index_type = (olx_gltf_component)type;
  if (!find_packed(gltf, indices, s->count, component_bytes(type), &s->index_view, &s->index_offset) ||
      !find_packed(gltf, values, s->count, a->components * component_bytes(a->type), &s->value_view,
                   &s->value_offset)) {
    return olx_gltf_fail(gltf, "accessors", i, "its sparse indices or values are not in their bufferView");
  }
  return OLX_OK;
}

// Limits accessors without a view, whose zeros take memory without any bytes in the file. Those without any data at all
// pass, since nothing may refer to them: programs that compress meshes leave such accessors behind.
static olx_result check_zeros(const olx_gltf *gltf, uint32_t i, const olx_gltf_accessor *a) {
  uint64_t size_bytes = gltf->file.size_bytes;
  for (uint32_t b = 0; b < gltf->buffers.count; ++b) size_bytes += gltf->buffer_data[b].bytes.size_bytes;
  if (a->count <= size_bytes) return OLX_OK;
  return olx_gltf_fail(gltf, "accessors", i, "it has no bufferView, and more elements than the file has bytes");
}

static olx_result read_place(const olx_gltf *gltf, uint32_t i, const cJSON *element, olx_gltf_accessor *a) {
  if (!olx_gltf_index(element, "bufferView", gltf->views.count, &a->view)) {
    return olx_gltf_fail(gltf, "accessors", i, "its bufferView does not exist");
  }
  const uint64_t element_bytes = a->components * component_bytes(a->type);
  a->stride = element_bytes;
  if (a->compressed) a->view = OLX_GLTF_NONE;
  if (a->view == OLX_GLTF_NONE) return a->compressed ? OLX_OK : check_zeros(gltf, i, a);
  const uint64_t stride = gltf->view_data[a->view].stride;
  if (stride) a->stride = stride;
  if (!olx_json_size(element, "byteOffset", 0, &a->offset) || a->stride < element_bytes ||
      a->offset + a->stride * (a->count - 1) + element_bytes > view_size(gltf, a->view)) {
    return olx_gltf_fail(gltf, "accessors", i, "it reaches past the end of its bufferView");
  }
  return OLX_OK;
}

static olx_result read_accessor(const olx_gltf *gltf, uint32_t i) {
  const cJSON *element = gltf->accessors.elements[i];
  olx_gltf_accessor *a = &gltf->accessor_data[i];
  uint64_t type;
  a->components = component_count(olx_json_text(element, "type"));
  if (!olx_json_size(element, "componentType", 0, &type) || !component_bytes(type) || !a->components) {
    return olx_gltf_fail(gltf, "accessors", i, "its type or componentType is not known");
  }
  a->type = (olx_gltf_component)type;
  a->normalized = cJSON_IsTrue(olx_json_member(element, "normalized"));
  if (!olx_json_size(element, "count", 0, &a->count) || a->count == 0 || a->count > UINT32_MAX / 4) {
    return olx_gltf_fail(gltf, "accessors", i, "its count is not a sensible number");
  }
  OLX_TRY(read_sparse(gltf, i, element, a));
  return read_place(gltf, i, element, a);
}

olx_result olx_gltf_make_accessors(olx_gltf *gltf) {
  gltf->accessor_data = olx_allocate_zero(gltf->accessors.count, sizeof *gltf->accessor_data);
  return gltf->accessor_data ? OLX_OK : olx_fail(OLX_ERROR_MEMORY, "%s: out of memory", gltf->path);
}

olx_result olx_gltf_open_accessors(olx_gltf *gltf) {
  for (uint32_t i = 0; i < gltf->accessors.count; ++i) OLX_TRY(read_accessor(gltf, i));
  return OLX_OK;
}

void olx_gltf_release_accessors(olx_gltf *gltf) {
  for (uint32_t i = 0; gltf->accessor_data && i < gltf->accessors.count; ++i) {
    olx_release(gltf->accessor_data[i].decoded);
  }
  olx_release(gltf->accessor_data);
}

// ---- Reading

static uint32_t integer_at(const uint8_t *bytes, olx_gltf_component type) {
  uint16_t two;
  uint32_t four;
  switch (type) {
  case OLX_GLTF_UINT8: return *bytes;
  case OLX_GLTF_UINT16: memcpy(&two, bytes, sizeof two); return two;
  default: memcpy(&four, bytes, sizeof four); return four;
  }
}

// Returns the largest value of an integer type, which represents 1 when normalized.
static float largest(olx_gltf_component type) {
  switch (type) {
  case OLX_GLTF_INT8: return 127.0f;
  case OLX_GLTF_UINT8: return 255.0f;
  case OLX_GLTF_INT16: return 32767.0f;
  case OLX_GLTF_UINT16: return 65535.0f;
  default: return 4294967295.0f;
  }
}

static float number_at(const uint8_t *bytes, olx_gltf_component type) {
  int16_t two;
  float four;
  switch (type) {
  case OLX_GLTF_INT8: return (float)(int8_t)*bytes;
  case OLX_GLTF_INT16: memcpy(&two, bytes, sizeof two); return (float)two;
  case OLX_GLTF_FLOAT: memcpy(&four, bytes, sizeof four); return four;
  default: return (float)integer_at(bytes, type);
  }
}

// Reads the components of one element.
static void read_element(const olx_gltf_accessor *a, const uint8_t *bytes, uint32_t components, float *numbers) {
  const uint64_t size_bytes = component_bytes(a->type);
  const bool scaled = a->normalized && a->type != OLX_GLTF_FLOAT;
  for (uint32_t k = 0; k < components && k < a->components; ++k) {
    const float number = number_at(bytes + k * size_bytes, a->type);
    numbers[k] = scaled ? fmaxf(number / largest(a->type), -1.0f) : number;
  }
}

// Reads `count` elements, which begin at `bytes`.
static void read_elements(const olx_gltf_accessor *a, const uint8_t *bytes, uint64_t count, uint32_t components,
                          float *numbers) {
  const size_t size_bytes = components * sizeof *numbers;
  const bool as_they_are = a->type == OLX_GLTF_FLOAT && components <= a->components;
  if (as_they_are && a->stride == size_bytes) {
    memcpy(numbers, bytes, count * size_bytes);
    return;
  }
  for (uint64_t i = 0; i < count; ++i, bytes += a->stride, numbers += components) {
    if (as_they_are) memcpy(numbers, bytes, size_bytes);
    else read_element(a, bytes, components, numbers);
  }
}

static void clear_elements(const olx_gltf_accessor *a, uint32_t components, float *numbers) {
  for (uint64_t i = 0; i < a->count; ++i) {
    for (uint32_t k = 0; k < components && k < a->components; ++k) numbers[i * components + k] = 0.0f;
  }
}

static olx_result replace_sparse(const olx_gltf *gltf, uint32_t accessor, uint32_t components, float *numbers) {
  const olx_gltf_accessor *a = &gltf->accessor_data[accessor];
  const olx_gltf_sparse *s = &a->sparse;
  olx_gltf_bytes indices, values;
  OLX_TRY(olx_gltf_view_bytes(gltf, s->index_view, &indices));
  OLX_TRY(olx_gltf_view_bytes(gltf, s->value_view, &values));
  const uint64_t index_bytes = component_bytes(s->index_type), value_bytes = a->components * component_bytes(a->type);
  for (uint64_t i = 0; i < s->count; ++i) {
    const uint32_t place = integer_at(indices.data + s->index_offset + i * index_bytes, s->index_type);
    if (place >= a->count) return olx_gltf_fail(gltf, "accessors", accessor, "a sparse index is out of range");
    read_element(a, values.data + s->value_offset + i * value_bytes, components,
                 numbers + (uint64_t)place * components);
  }
  return OLX_OK;
}

// Finds the first element of an accessor; NULL when all are 0 unless replaced.
static olx_result find_elements(const olx_gltf *gltf, uint32_t accessor, const uint8_t **elements) {
  const olx_gltf_accessor *a = &gltf->accessor_data[accessor];
  *elements = a->decoded;
  if (a->view == OLX_GLTF_NONE && !a->decoded && !a->sparse.count) {
    return olx_gltf_fail(gltf, "accessors", accessor, "it has no data: neither a bufferView nor sparse values");
  }
  if (a->view == OLX_GLTF_NONE) return OLX_OK;
  olx_gltf_bytes bytes;
  OLX_TRY(olx_gltf_view_bytes(gltf, a->view, &bytes));
  *elements = bytes.data + a->offset;
  return OLX_OK;
}

olx_result olx_gltf_read_floats(const olx_gltf *gltf, uint32_t accessor, uint32_t components, float *numbers) {
  const olx_gltf_accessor *a = &gltf->accessor_data[accessor];
  const uint8_t *elements;
  OLX_TRY(find_elements(gltf, accessor, &elements));
  if (elements) read_elements(a, elements, a->count, components, numbers);
  else clear_elements(a, components, numbers);
  return a->sparse.count ? replace_sparse(gltf, accessor, components, numbers) : OLX_OK;
}

olx_result olx_gltf_read_first_floats(const olx_gltf *gltf, uint32_t accessor, uint64_t count, uint32_t components,
                                      float *numbers) {
  const uint8_t *elements;
  OLX_TRY(find_elements(gltf, accessor, &elements));
  read_elements(&gltf->accessor_data[accessor], elements, count, components, numbers);
  return OLX_OK;
}

static olx_result replace_sparse_indices(const olx_gltf *gltf, uint32_t accessor, uint32_t *indices) {
  const olx_gltf_accessor *a = &gltf->accessor_data[accessor];
  const olx_gltf_sparse *s = &a->sparse;
  olx_gltf_bytes places, values;
  OLX_TRY(olx_gltf_view_bytes(gltf, s->index_view, &places));
  OLX_TRY(olx_gltf_view_bytes(gltf, s->value_view, &values));
  const uint64_t index_bytes = component_bytes(s->index_type), value_bytes = component_bytes(a->type);
  for (uint64_t i = 0; i < s->count; ++i) {
    const uint32_t place = integer_at(places.data + s->index_offset + i * index_bytes, s->index_type);
    if (place >= a->count) return olx_gltf_fail(gltf, "accessors", accessor, "a sparse index is out of range");
    indices[place] = integer_at(values.data + s->value_offset + i * value_bytes, a->type);
  }
  return OLX_OK;
}

olx_result olx_gltf_read_indices(const olx_gltf *gltf, uint32_t accessor, uint32_t *indices) {
  const olx_gltf_accessor *a = &gltf->accessor_data[accessor];
  const uint8_t *elements;
  OLX_TRY(find_elements(gltf, accessor, &elements));
  if (elements) {
    for (uint64_t i = 0; i < a->count; ++i) indices[i] = integer_at(elements + i * a->stride, a->type);
  } else {
    memset(indices, 0, a->count * sizeof *indices);
  }
  return a->sparse.count ? replace_sparse_indices(gltf, accessor, indices) : OLX_OK;
}
