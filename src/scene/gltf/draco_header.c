// Reads the first bytes of a Draco stream, so that what it claims is checked before its decoder allocates memory for it.
#include "scene/gltf/draco_mesh.h"

#include <string.h>

// Bounds the faces of a stream by its bytes. A plane of a million equal squares, which compresses best, has 488.
#define MOST_FACES_PER_BYTE 1024u

enum { HEADER_BYTES = 11, MESH = 1, SEQUENTIAL = 0, EDGEBREAKER = 1, METADATA = 0x80 };

typedef struct byte_reader {
  const uint8_t *next, *end;
} byte_reader;

// Reads a number of up to 32 bits, seven to a byte, the low ones first.
static bool read_number(byte_reader *r, uint32_t *number) {
  *number = 0;
  for (uint32_t shift = 0; shift < 32 && r->next < r->end; shift += 7) {
    const uint32_t byte = *r->next++;
    *number |= (byte & 0x7F) << shift;
    if (byte < 0x80) return true;
  }
  return false;
}

// Connectivity of faces that are listed one by one: their number, and that of points.
static bool read_sequential(byte_reader *r, olx_draco_header *header) {
  return read_number(r, &header->faces) && read_number(r, &header->most_points);
}

// Connectivity by edgebreaker: the kind of traversal, the number of vertices, and that of faces. Seams of attributes
// divide vertices into more points, at most one for each corner.
static bool read_edgebreaker(byte_reader *r, olx_draco_header *header) {
  uint32_t vertices;
  if (r->next == r->end) return false;
  ++r->next;
  if (!read_number(r, &vertices) || !read_number(r, &header->faces) || header->faces > UINT32_MAX / 3) return false;
  header->most_points = 3 * header->faces;
  return vertices <= header->most_points;
}

const char *olx_draco_read_header(const uint8_t *data, size_t size_bytes, olx_draco_header *header) {
  if (size_bytes < HEADER_BYTES || memcmp(data, "DRACO", 5) != 0) return "its bytes are no Draco stream";
  const uint8_t method = data[8];
  byte_reader r = {data + HEADER_BYTES, data + size_bytes};
  if (data[5] != 2 || data[6] != 2) return "its Draco stream is not of version 2.2";
  if (data[7] != MESH) return "its Draco stream has no triangles";
  if (data[10] & METADATA) return "its Draco stream has metadata, which is not supported";
  const bool read = method == SEQUENTIAL    ? read_sequential(&r, header)
                    : method == EDGEBREAKER ? read_edgebreaker(&r, header)
                                            : false;
  if (!read) return "the header of its Draco stream is damaged";
  const uint64_t most = (uint64_t)size_bytes * MOST_FACES_PER_BYTE;
  return header->faces > most || header->most_points > 3 * most ? "its bytes cannot hold so many triangles" : NULL;
}
