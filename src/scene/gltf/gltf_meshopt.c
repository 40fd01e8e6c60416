// Decompresses views with meshoptimizer, which is safe on hostile streams, after their declared sizes have been checked
// and before memory is allocated for them.
#include "scene/gltf/gltf_meshopt.h"

#include "core/hooks.h"
#include "core/result.h"

#include <string.h>

#include <meshoptimizer.h>

// Bound on the expansion: a vertex stream encodes 16 equal bytes by two bits; the other modes take at least one byte
// per index.
#define MOST_EXPANSION 64u

typedef enum meshopt_mode { MODE_ATTRIBUTES, MODE_TRIANGLES, MODE_INDICES, MODE_UNKNOWN } meshopt_mode;
typedef enum meshopt_filter {
  FILTER_NONE,
  FILTER_OCTAHEDRAL,
  FILTER_QUATERNION,
  FILTER_EXPONENTIAL,
  FILTER_UNKNOWN
} meshopt_filter;

const cJSON *olx_gltf_meshopt_of(const cJSON *element) {
  static const char *const names[] = {"EXT_meshopt_compression", "KHR_meshopt_compression", "MESHOPT_compression"};
  for (size_t i = 0; i < sizeof names / sizeof *names; ++i) {
    const cJSON *found = olx_gltf_extension(element, names[i]);
    if (found) return found;
  }
  return NULL;
}

static uint32_t find_name(const char *name, const char *const *names, uint32_t count) {
  uint32_t i = 0;
  while (i < count && strcmp(name, names[i]) != 0) ++i;
  return i;
}

static meshopt_mode mode_of(const cJSON *compressed) {
  static const char *const names[] = {"ATTRIBUTES", "TRIANGLES", "INDICES"};
  return (meshopt_mode)find_name(olx_json_text(compressed, "mode"), names, MODE_UNKNOWN);
}

static meshopt_filter filter_of(const cJSON *compressed) {
  static const char *const names[] = {"NONE", "OCTAHEDRAL", "QUATERNION", "EXPONENTIAL"};
  if (!olx_json_member(compressed, "filter")) return FILTER_NONE;
  return (meshopt_filter)find_name(olx_json_text(compressed, "filter"), names, FILTER_UNKNOWN);
}

uint64_t olx_gltf_meshopt_size(const cJSON *compressed) {
  uint64_t count = 0, stride = 0;
  olx_json_size(compressed, "count", 0, &count);
  olx_json_size(compressed, "byteStride", 0, &stride);
  return count * stride;
}

static bool fits_filter(meshopt_filter filter, uint64_t stride) {
  if (filter == FILTER_OCTAHEDRAL) return stride == 4 || stride == 8;
  return filter != FILTER_QUATERNION || stride == 8;
}

static const char *find_problem(const cJSON *compressed, uint64_t size_bytes) {
  uint64_t count, stride;
  const meshopt_mode mode = mode_of(compressed);
  const meshopt_filter filter = filter_of(compressed);
  if (mode == MODE_UNKNOWN) return "its meshopt mode is not known";
  if (filter == FILTER_UNKNOWN) return "its meshopt filter is not known";
  if (!olx_json_size(compressed, "count", 0, &count) || !olx_json_size(compressed, "byteStride", 0, &stride) ||
      count == 0 || count > UINT32_MAX / 4) {
    return "its meshopt count is not a sensible number";
  }
  const bool indices = mode != MODE_ATTRIBUTES;
  if (indices ? stride != 2 && stride != 4 : stride == 0 || stride > 256 || stride % 4) {
    return "its meshopt byteStride is not one that its mode can have";
  }
  if (indices ? filter != FILTER_NONE : !fits_filter(filter, stride))
    return "its meshopt filter does not fit its elements";
  if (mode == MODE_TRIANGLES && count % 3) return "its meshopt count is not that of triangles";
  if (count * stride / MOST_EXPANSION > size_bytes) return "its bytes cannot hold so many elements";
  return NULL;
}

olx_result olx_gltf_meshopt_check(const olx_gltf *gltf, uint32_t view, const cJSON *compressed, uint64_t size_bytes,
                                  uint64_t *stride) {
  const char *problem = find_problem(compressed, size_bytes);
  olx_json_size(compressed, "byteStride", 0, stride);
  return problem ? olx_gltf_fail(gltf, "bufferViews", view, problem) : OLX_OK;
}

static bool decode_stream(const cJSON *compressed, olx_gltf_bytes from, size_t count, size_t stride, void *to) {
  switch (mode_of(compressed)) {
  case MODE_ATTRIBUTES: return meshopt_decodeVertexBuffer(to, count, stride, from.data, from.size_bytes) == 0;
  case MODE_TRIANGLES: return meshopt_decodeIndexBuffer(to, count, stride, from.data, from.size_bytes) == 0;
  case MODE_INDICES: return meshopt_decodeIndexSequence(to, count, stride, from.data, from.size_bytes) == 0;
  case MODE_UNKNOWN: break;
  }
  return false;
}

static void undo_filter(meshopt_filter filter, void *elements, size_t count, size_t stride) {
  if (filter == FILTER_OCTAHEDRAL) meshopt_decodeFilterOct(elements, count, stride);
  if (filter == FILTER_QUATERNION) meshopt_decodeFilterQuat(elements, count, stride);
  if (filter == FILTER_EXPONENTIAL) meshopt_decodeFilterExp(elements, count, stride);
}

olx_result olx_gltf_meshopt_decode(const olx_gltf *gltf, uint32_t view, const cJSON *compressed, olx_gltf_bytes bytes,
                                   uint8_t **decoded) {
  uint64_t stride = 0;
  olx_json_size(compressed, "byteStride", 0, &stride);
  const size_t count = olx_gltf_meshopt_size(compressed) / stride;
  uint8_t *elements = olx_allocate(count, stride);
  if (!elements) return olx_fail(OLX_ERROR_MEMORY, "%s: out of memory for bufferViews[%u]", gltf->path, view);
  if (!decode_stream(compressed, bytes, count, stride, elements)) {
    olx_release(elements);
    return olx_gltf_fail(gltf, "bufferViews", view, "its meshopt data cannot be decoded");
  }
  undo_filter(filter_of(compressed), elements, count, stride);
  *decoded = elements;
  return OLX_OK;
}
