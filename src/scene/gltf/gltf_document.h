// An open glTF file: its JSON as arrays of elements, and the data that the other gltf_*.h files keep beside it.
#ifndef OLX_SCENE_GLTF_DOCUMENT_H
#define OLX_SCENE_GLTF_DOCUMENT_H

#include "core/file.h"
#include "scene/import/json_value.h"
#include "scene/scene_data.h"

#define OLX_GLTF_NONE UINT32_MAX

// The objects of an array of the file.
typedef struct olx_gltf_list {
  const cJSON **elements;
  uint32_t count;
} olx_gltf_list;

typedef struct olx_gltf_bytes {
  const uint8_t *data;
  uint64_t size_bytes;
} olx_gltf_bytes;

typedef struct olx_gltf_buffer olx_gltf_buffer;     // gltf_buffer.h
typedef struct olx_gltf_view olx_gltf_view;         // gltf_buffer.h
typedef struct olx_gltf_accessor olx_gltf_accessor; // gltf_accessor.h
typedef struct olx_gltf_image olx_gltf_image;       // gltf_texture.c

typedef struct olx_gltf {
  const char *path;
  olx_scene *scene; // the scene that the file is read into
  olx_mapped_file file;
  olx_gltf_bytes binary; // the part of a .glb after its JSON
  cJSON *root;
  olx_gltf_list buffers, views, accessors, materials, meshes, nodes, scenes, images, textures, samplers, skins, cameras,
      lights;
  olx_gltf_buffer *buffer_data;     // one per buffer
  olx_gltf_view *view_data;         // one per view
  olx_gltf_accessor *accessor_data; // one per accessor
  olx_gltf_image *image_data;       // one per image, allocated when the first texture requests one
} olx_gltf;

// Maps a .gltf or .glb file and parses its JSON. Versions other than 2 and unsupported required extensions are
// rejected; ignored extensions become warnings of the scene. olx_gltf_close must be called, also after a failure; it
// releases what this function allocates, and leaves data that other files keep in the document to them.
olx_result olx_gltf_open(const char *path, olx_scene *scene, olx_gltf *gltf);
void olx_gltf_close(olx_gltf *gltf);

// Fails with OLX_ERROR_FORMAT and a message such as "room.gltf: accessors[3]: WHAT".
olx_result olx_gltf_fail(const olx_gltf *gltf, const char *list, uint32_t element, const char *what);

// Reads an optional member that must be an index below `count` when present. *index is OLX_GLTF_NONE when it is absent.
bool olx_gltf_index(const cJSON *object, const char *key, uint32_t count, uint32_t *index);

// Returns an extension of an element, or NULL.
const cJSON *olx_gltf_extension(const cJSON *element, const char *name);

#endif
