// A glTF file that is being read: its JSON as arrays of elements, and what the other gltf_*.h files keep beside them.
#ifndef OLX_SCENE_GLTF_DOCUMENT_H
#define OLX_SCENE_GLTF_DOCUMENT_H

#include "core/file.h"
#include "scene/json_value.h"
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
  olx_scene *scene; // that the file is read into
  olx_mapped_file file;
  olx_gltf_bytes binary; // what a .glb has after its JSON
  cJSON *root;
  olx_gltf_list buffers, views, accessors, materials, meshes, nodes, scenes, images, textures, cameras, lights;
  olx_gltf_buffer *buffer_data;     // one a buffer
  olx_gltf_view *view_data;         // one a view
  olx_gltf_accessor *accessor_data; // one an accessor
  olx_gltf_image *image_data;       // one an image, once a texture has asked for one
} olx_gltf;

// Map a .gltf or .glb file and parse its JSON. Versions other than 2 and required extensions that are not supported are
// refused; extensions that are ignored become warnings of the scene. Whatever comes back,
// olx_gltf_close releases what this has made, and leaves what other files keep in the document to them.
olx_result olx_gltf_open(const char *path, olx_scene *scene, olx_gltf *gltf);
void olx_gltf_close(olx_gltf *gltf);

// OLX_ERROR_FORMAT with a message such as "room.gltf: accessors[3]: WHAT".
olx_result olx_gltf_fail(const olx_gltf *gltf, const char *list, uint32_t element, const char *what);

// An optional member that must be an index below `count` when it is there. *index is OLX_GLTF_NONE when it is absent.
bool olx_gltf_index(const cJSON *object, const char *key, uint32_t count, uint32_t *index);

// An extension of an element, or NULL.
const cJSON *olx_gltf_extension(const cJSON *element, const char *name);

#endif
