// Makes small glTF files piece by piece.
#ifndef OLX_TESTS_GLTF_MAKER_H
#define OLX_TESTS_GLTF_MAKER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
  GLTF_INT8 = 5120,
  GLTF_UINT8 = 5121,
  GLTF_INT16 = 5122,
  GLTF_UINT16 = 5123,
  GLTF_UINT32 = 5125,
  GLTF_FLOAT = 5126
};

// One buffer, and the JSON of its views and accessors. Zero-initialise.
typedef struct gltf_maker {
  uint8_t bytes[4096];
  size_t size_bytes;
  char views[4096], accessors[4096];
  uint32_t view_count, accessor_count;
} gltf_maker;

// Appends to a text, as printf does; whatever exceeds the capacity is cut off.
void gltf_append(char *text, size_t capacity, const char *format, ...) __attribute__((format(printf, 3, 4)));

// Returns the number of a new view. `more` is appended to its object and starts with a comma unless it is empty.
uint32_t gltf_add_view(gltf_maker *m, const void *data, size_t size_bytes, const char *more);
// Returns the number of a new accessor; `of` comes first in its object and ends with a comma unless it is empty.
uint32_t gltf_add_accessor(gltf_maker *m, const char *of, uint32_t count, int component, const char *type);
// Returns the number of a new accessor of packed elements, in a view of their own.
uint32_t gltf_add(gltf_maker *m, const void *data, size_t size_bytes, uint32_t count, int component, const char *type,
                  bool normalized);

// Returns the number of a new view of bytes that meshoptimizer compressed, by the extension `name`. Its uncompressed
// form would be in the fallback buffer. `mode` is JSON: "\"mode\": \"TRIANGLES\"".
uint32_t gltf_add_compressed(gltf_maker *m, const char *name, const uint8_t *code, size_t size_bytes, uint32_t count,
                             uint32_t stride, const char *mode);
// Add compressed accessors of four vertices of three numbers, and of the indices of a square. `filter` is JSON after
// the mode, or empty.
void gltf_add_vertices(gltf_maker *m, const char *name, const void *vertices, uint32_t stride, const char *filter,
                       const char *of, int component);
void gltf_add_indices(gltf_maker *m, const char *name, bool triangles);

// Returns the text of the whole file, to be freed: one mesh of `primitive` (JSON, perhaps several), nodes, and a second
// buffer that is a meshopt fallback. `more` is appended to the root object and starts with a comma unless it is empty.
// The buffer of a `binary` text is the binary chunk of the .glb around it.
char *gltf_maker_text(const gltf_maker *m, const char *primitive, const char *nodes, const char *more, bool binary);

// Makes a .glb of a text and the bytes of its buffer, in *data, to be freed; returns its size.
size_t gltf_make_glb(const char *text, size_t text_bytes, const uint8_t *bytes, size_t size_bytes, uint8_t **data);

#endif
