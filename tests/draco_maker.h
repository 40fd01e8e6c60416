// Makes Draco streams with Draco's own encoder.
#ifndef OLX_TESTS_DRACO_MAKER_H
#define OLX_TESTS_DRACO_MAKER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { DRACO_POSITIONS = 0, DRACO_NORMALS = 1, DRACO_UVS = 2 }; // the attributes' numbers in a stream

typedef struct draco_mesh {
  const float *positions, *normals, *uvs; // three, three and two numbers a point
  uint32_t points;
  const uint32_t *indices;
  uint32_t faces;
  bool sequential; // instead of edgebreaker
} draco_mesh;

// Encodes a mesh without loss; the order of its points can change. Returns the stream's size; 0 when it does not fit.
size_t draco_encode(const draco_mesh *mesh, uint8_t *stream, size_t capacity);

#ifdef __cplusplus
}
#endif

#endif
