// Meshes that Draco compressed. Its library is written in C++ and has no C interface; this is the part of one that glTF
// needs.
#ifndef OLX_SCENE_DRACO_MESH_H
#define OLX_SCENE_DRACO_MESH_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct olx_draco_mesh olx_draco_mesh;

// What a stream says of itself in its first bytes.
typedef struct olx_draco_header {
  uint32_t faces;
  uint32_t most_points; // no stream of that header has more
} olx_draco_header;

// Reads a stream's header. Returns NULL, or what is wrong with it as the end of a sentence: only triangles in version
// 2.2 of the format, which glTF prescribes, without metadata, and not more of them than so many bytes can hold.
const char *olx_draco_read_header(const uint8_t *data, size_t size_bytes, olx_draco_header *header);

// Decodes a stream; NULL when it is damaged or memory ends. The caller releases the mesh with olx_draco_release.
olx_draco_mesh *olx_draco_decode(const uint8_t *data, size_t size_bytes);
void olx_draco_release(olx_draco_mesh *mesh);

uint32_t olx_draco_points(const olx_draco_mesh *mesh);
uint32_t olx_draco_faces(const olx_draco_mesh *mesh);

// Writes one attribute of every point, packed: `components` numbers of a glTF component type. Returns false when the
// mesh has no such attribute, or its numbers do not fit that type.
bool olx_draco_read_attribute(const olx_draco_mesh *mesh, uint32_t unique_id, int component_type, uint32_t components,
                              void *elements);

// Writes the three points of every face, packed, as numbers of an unsigned component type. Returns false when they do
// not fit that type.
bool olx_draco_read_faces(const olx_draco_mesh *mesh, int component_type, void *points);

#ifdef __cplusplus
}
#endif

#endif
