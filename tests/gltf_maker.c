// Makes small glTF files for tests from arrays that are put behind each other into one buffer, together with the JSON
// that refers to them.
#include "gltf_maker.h"

#include "data_uris.h"

#include <meshoptimizer.h>

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void gltf_append(char *text, size_t capacity, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  const size_t used = strlen(text);
  vsnprintf(text + used, capacity - used, format, arguments);
  va_end(arguments);
}

// Copies bytes into the buffer and returns their offset.
static size_t add_bytes(gltf_maker *m, const void *data, size_t size_bytes) {
  const size_t offset = (m->size_bytes + 3) & ~(size_t)3;
  if (offset + size_bytes > sizeof m->bytes) abort();
  memcpy(m->bytes + offset, data, size_bytes);
  m->size_bytes = offset + size_bytes;
  return offset;
}

uint32_t gltf_add_view(gltf_maker *m, const void *data, size_t size_bytes, const char *more) {
  const size_t offset = add_bytes(m, data, size_bytes);
  gltf_append(m->views, sizeof m->views, "%s{\"buffer\": 0, \"byteOffset\": %zu, \"byteLength\": %zu%s}",
              m->view_count ? ", " : "", offset, size_bytes, more);
  return m->view_count++;
}

uint32_t gltf_add_accessor(gltf_maker *m, const char *of, uint32_t count, int component, const char *type) {
  gltf_append(m->accessors, sizeof m->accessors, "%s{%s\"count\": %u, \"componentType\": %d, \"type\": \"%s\"}",
              m->accessor_count ? ", " : "", of, count, component, type);
  return m->accessor_count++;
}

uint32_t gltf_add(gltf_maker *m, const void *data, size_t size_bytes, uint32_t count, int component, const char *type,
                  bool normalized) {
  char of[64];
  snprintf(of, sizeof of, "\"bufferView\": %u, \"normalized\": %s, ", gltf_add_view(m, data, size_bytes, ""),
           normalized ? "true" : "false");
  return gltf_add_accessor(m, of, count, component, type);
}

uint32_t gltf_add_compressed(gltf_maker *m, const char *name, const uint8_t *code, size_t size_bytes, uint32_t count,
                             uint32_t stride, const char *mode) {
  const size_t offset = add_bytes(m, code, size_bytes);
  gltf_append(m->views, sizeof m->views,
              "%s{\"buffer\": 1, \"byteLength\": %u, \"extensions\": {\"%s\": {\"buffer\": 0, \"byteOffset\": %zu, "
              "\"byteLength\": %zu, \"byteStride\": %u, \"count\": %u, %s}}}",
              m->view_count ? ", " : "", count * stride, name, offset, size_bytes, stride, count, mode);
  return m->view_count++;
}

void gltf_add_vertices(gltf_maker *m, const char *name, const void *vertices, uint32_t stride, const char *filter,
                       const char *of, int component) {
  uint8_t code[512];
  char mode[96], place[160];
  const size_t size_bytes = meshopt_encodeVertexBuffer(code, sizeof code, vertices, 4, stride);
  snprintf(mode, sizeof mode, "\"mode\": \"ATTRIBUTES\"%s", filter);
  snprintf(place, sizeof place, "\"bufferView\": %u, %s",
           gltf_add_compressed(m, name, code, size_bytes, 4, stride, mode), of);
  gltf_add_accessor(m, place, 4, component, "VEC3");
}

void gltf_add_indices(gltf_maker *m, const char *name, bool triangles) {
  const unsigned indices[6] = {0, 1, 2, 0, 2, 3};
  uint8_t code[512];
  char place[64];
  const size_t size_bytes = triangles ? meshopt_encodeIndexBuffer(code, sizeof code, indices, 6)
                                      : meshopt_encodeIndexSequence(code, sizeof code, indices, 6);
  const uint32_t view = gltf_add_compressed(m, name, code, size_bytes, 6, triangles ? 2 : 4,
                                            triangles ? "\"mode\": \"TRIANGLES\"" : "\"mode\": \"INDICES\"");
  snprintf(place, sizeof place, "\"bufferView\": %u, ", view);
  gltf_add_accessor(m, place, 6, triangles ? GLTF_UINT16 : GLTF_UINT32, "SCALAR");
}

char *gltf_maker_text(const gltf_maker *m, const char *primitive, const char *nodes, const char *more, bool binary) {
  const size_t capacity = 32768 + strlen(primitive) + strlen(nodes) + strlen(more);
  char *uri = make_data_uri(m->bytes, m->size_bytes), *text = malloc(capacity);
  snprintf(text, capacity,
           "{\"asset\": {\"version\": \"2.0\"}, \"scenes\": [{\"nodes\": [0]}], \"nodes\": %s,\n"
           "\"meshes\": [{\"primitives\": [%s]}],\n\"accessors\": [%s],\n\"bufferViews\": [%s],\n"
           "\"buffers\": [{\"byteLength\": %zu%s%s%s}, {\"byteLength\": 4096, \"extensions\": "
           "{\"EXT_meshopt_compression\": {\"fallback\": true}}}]%s}",
           nodes, primitive, m->accessors, m->views, m->size_bytes, binary ? "" : ", \"uri\": \"", binary ? "" : uri,
           binary ? "" : "\"", more);
  free(uri);
  return text;
}

size_t gltf_make_glb(const char *text, size_t text_bytes, const uint8_t *bytes, size_t size_bytes, uint8_t **data) {
  const size_t padded = (text_bytes + 3) & ~(size_t)3, total = 20 + padded + 8 + size_bytes;
  const uint32_t header[5] = {0x46546C67u, 2, (uint32_t)total, (uint32_t)padded, 0x4E4F534Au};
  const uint32_t chunk[2] = {(uint32_t)size_bytes, 0x004E4942u};
  uint8_t *made = malloc(total);
  memset(made, ' ', total);
  memcpy(made, header, sizeof header);
  memcpy(made + 20, text, text_bytes);
  memcpy(made + 20 + padded, chunk, sizeof chunk);
  memcpy(made + 28 + padded, bytes, size_bytes);
  *data = made;
  return total;
}
