// Maps the buffers of a glTF file, or decodes them from data: URIs, and locates the views in them. Only compressed data
// is copied.
#include "scene/gltf/gltf_buffer.h"

#include "core/hooks.h"
#include "core/result.h"
#include "scene/gltf/gltf_meshopt.h"
#include "scene/import/data_uri.h"
#include "scene/import/model_files.h"
#include "scene/sources.h"

#include <string.h>

// ---- Buffers

static olx_result open_file(const olx_gltf *gltf, const char *uri, olx_gltf_buffer *buffer) {
  char path[8192];
  olx_model_file_locate(gltf->path, uri, path, sizeof path);
  OLX_TRY(olx_model_file_check(gltf->scene, gltf->path, path));
  OLX_TRY(olx_map_file(path, &buffer->mapped));
  buffer->bytes = (olx_gltf_bytes){buffer->mapped.data, buffer->mapped.size_bytes};
  return olx_scene_note_source(gltf->scene, path);
}

static olx_result decode_uri(const olx_gltf *gltf, const char *uri, uint32_t index, olx_gltf_buffer *buffer) {
  size_t size_bytes;
  if (olx_data_uri_decode(uri, &buffer->decoded, &size_bytes)) {
    buffer->bytes = (olx_gltf_bytes){buffer->decoded, size_bytes};
    return OLX_OK;
  }
  if (size_bytes == SIZE_MAX) return olx_fail(OLX_ERROR_MEMORY, "%s: out of memory", gltf->path);
  return olx_gltf_fail(gltf, "buffers", index, "its data: URI is not in base64");
}

static olx_result find_bytes(const olx_gltf *gltf, uint32_t index, olx_gltf_buffer *buffer) {
  const cJSON *uri = olx_json_member(gltf->buffers.elements[index], "uri");
  if (cJSON_IsString(uri)) {
    if (olx_is_data_uri(uri->valuestring)) return decode_uri(gltf, uri->valuestring, index, buffer);
    const olx_result result = open_file(gltf, uri->valuestring, buffer);
    if (result == OLX_OK || result == OLX_ERROR_UNSUPPORTED) return result;
    return olx_fail(result, "%s: buffers[%u]: %s", gltf->path, index, olx_last_error());
  }
  if (uri) return olx_gltf_fail(gltf, "buffers", index, "its uri is no text");
  if (index == 0) buffer->bytes = gltf->binary;
  return OLX_OK;
}

static olx_result open_buffer(const olx_gltf *gltf, uint32_t index) {
  olx_gltf_buffer *buffer = &gltf->buffer_data[index];
  uint64_t size_bytes;
  buffer->fallback = cJSON_IsTrue(olx_json_member(olx_gltf_meshopt_of(gltf->buffers.elements[index]), "fallback"));
  if (buffer->fallback) return OLX_OK;
  if (!olx_json_size(gltf->buffers.elements[index], "byteLength", UINT64_MAX, &size_bytes) ||
      size_bytes == UINT64_MAX) {
    return olx_gltf_fail(gltf, "buffers", index, "its byteLength is not a number of bytes");
  }
  OLX_TRY(find_bytes(gltf, index, buffer));
  if (buffer->bytes.size_bytes < size_bytes) {
    return olx_fail(OLX_ERROR_FORMAT, "%s: buffers[%u]: it has %llu bytes, not the %llu that its byteLength says",
                    gltf->path, index, (unsigned long long)buffer->bytes.size_bytes, (unsigned long long)size_bytes);
  }
  buffer->bytes.size_bytes = size_bytes;
  return OLX_OK;
}

// ---- Views

// Finds the part of a buffer that an object with buffer, byteOffset and byteLength refers to.
static olx_result find_part(const olx_gltf *gltf, const cJSON *object, uint32_t view, olx_gltf_bytes *bytes) {
  uint32_t buffer;
  uint64_t offset, size_bytes;
  if (!olx_gltf_index(object, "buffer", gltf->buffers.count, &buffer) || buffer == OLX_GLTF_NONE) {
    return olx_gltf_fail(gltf, "bufferViews", view, "its buffer does not exist");
  }
  const olx_gltf_bytes whole = gltf->buffer_data[buffer].bytes;
  if (gltf->buffer_data[buffer].fallback) {
    return olx_gltf_fail(gltf, "bufferViews", view, "its buffer is a fallback for readers without meshopt");
  }
  if (!olx_json_size(object, "byteOffset", 0, &offset) || !olx_json_size(object, "byteLength", 0, &size_bytes) ||
      offset + size_bytes > whole.size_bytes) {
    return olx_gltf_fail(gltf, "bufferViews", view, "it reaches past the end of its buffer");
  }
  *bytes = (olx_gltf_bytes){whole.data ? whole.data + offset : NULL, size_bytes};
  return OLX_OK;
}

static olx_result open_view(const olx_gltf *gltf, uint32_t index) {
  const cJSON *element = gltf->views.elements[index];
  olx_gltf_view *view = &gltf->view_data[index];
  if (!olx_json_size(element, "byteStride", 0, &view->stride) || view->stride > 1024) {
    return olx_gltf_fail(gltf, "bufferViews", index, "its byteStride is not a sensible number");
  }
  view->compressed = olx_gltf_meshopt_of(element);
  if (!view->compressed) return find_part(gltf, element, index, &view->bytes);
  OLX_TRY(find_part(gltf, view->compressed, index, &view->bytes));
  return olx_gltf_meshopt_check(gltf, index, view->compressed, view->bytes.size_bytes, &view->stride);
}

// Checks compressed views, each of which is decoded into separate memory.
static olx_result check_compressed(const olx_gltf *gltf) {
  uint64_t available = 0, taken = 0;
  for (uint32_t i = 0; i < gltf->buffers.count; ++i) available += gltf->buffer_data[i].bytes.size_bytes;
  for (uint32_t i = 0; i < gltf->views.count; ++i) {
    if (gltf->view_data[i].compressed) taken += gltf->view_data[i].bytes.size_bytes;
    if (taken > available)
      return olx_gltf_fail(gltf, "bufferViews", i, "it shares its bytes with other compressed views");
  }
  return OLX_OK;
}

olx_result olx_gltf_open_buffers(olx_gltf *gltf) {
  gltf->buffer_data = olx_allocate_zero(gltf->buffers.count, sizeof *gltf->buffer_data);
  gltf->view_data = olx_allocate_zero(gltf->views.count, sizeof *gltf->view_data);
  if (!gltf->buffer_data || !gltf->view_data) return olx_fail(OLX_ERROR_MEMORY, "%s: out of memory", gltf->path);
  for (uint32_t i = 0; i < gltf->buffers.count; ++i) OLX_TRY(open_buffer(gltf, i));
  for (uint32_t i = 0; i < gltf->views.count; ++i) OLX_TRY(open_view(gltf, i));
  return check_compressed(gltf);
}

void olx_gltf_release_buffers(olx_gltf *gltf) {
  for (uint32_t i = 0; gltf->view_data && i < gltf->views.count; ++i) olx_release(gltf->view_data[i].decoded);
  for (uint32_t i = 0; gltf->buffer_data && i < gltf->buffers.count; ++i) {
    olx_release(gltf->buffer_data[i].decoded);
    olx_unmap_file(&gltf->buffer_data[i].mapped);
  }
  olx_release(gltf->view_data);
  olx_release(gltf->buffer_data);
}

olx_result olx_gltf_view_bytes(const olx_gltf *gltf, uint32_t view, olx_gltf_bytes *bytes) {
  olx_gltf_view *found = &gltf->view_data[view];
  if (found->compressed && !found->decoded) {
    OLX_TRY(olx_gltf_meshopt_decode(gltf, view, found->compressed, found->bytes, &found->decoded));
    found->bytes = (olx_gltf_bytes){found->decoded, olx_gltf_meshopt_size(found->compressed)};
  }
  *bytes = found->bytes;
  return OLX_OK;
}

olx_result olx_gltf_check_images(const olx_gltf *gltf) {
  uint64_t available = 0, taken = 0;
  for (uint32_t i = 0; i < gltf->buffers.count; ++i) available += gltf->buffer_data[i].bytes.size_bytes;
  for (uint32_t i = 0; i < gltf->images.count; ++i) {
    uint32_t view;
    if (!olx_gltf_index(gltf->images.elements[i], "bufferView", gltf->views.count, &view)) {
      return olx_gltf_fail(gltf, "images", i, "its bufferView does not exist");
    }
    if (view == OLX_GLTF_NONE) continue;
    taken += gltf->view_data[view].bytes.size_bytes;
    if (taken > available) return olx_gltf_fail(gltf, "images", i, "it shares its bytes with other images");
  }
  return OLX_OK;
}
