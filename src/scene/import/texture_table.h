// The textures that a model requests: each decoded once, all in parallel, with missing ones reported.
#ifndef OLX_SCENE_TEXTURE_TABLE_H
#define OLX_SCENE_TEXTURE_TABLE_H

#include "scene/images/texture_file.h"
#include "scene/name_index.h"

typedef struct olx_texture_request {
  char *path;       // used in messages, and read when data is NULL
  const void *data; // an image inside the model file; not owned
  size_t size_bytes;
  olx_texture_use use;
  olx_texture texture;
  uint32_t scene_index; // OLX_NO_TEXTURE when it could not be read
  char error[256];
} olx_texture_request;

typedef struct olx_texture_table {
  olx_texture_request *requests;
  uint32_t count, capacity;
  olx_name_index paths; // index of the requests by path
} olx_texture_table;

// Requests a texture and returns its index in the table. `path` is copied.
olx_result olx_texture_table_request(olx_texture_table *table, const char *path, const void *data, size_t size_bytes,
                                     olx_texture_use use, uint32_t *number);

// Notes that the texture named `label` is left out, and why; the warning is among those of textures that cannot be read.
olx_result olx_texture_table_leave_out(olx_texture_table *table, const char *label, const char *why);

// Decodes all textures, which remain the table's. Unreadable images become warnings of the scene; images that exceed
// its limit of texels are rejected before any is decoded.
olx_result olx_texture_table_decode(olx_texture_table *table, const char *model_path, olx_scene *scene);

// Decodes all textures and appends them to the scene.
olx_result olx_texture_table_load(olx_texture_table *table, const char *model_path, olx_scene *scene);

// Returns the scene's texture for an index of the table; OLX_NO_TEXTURE for OLX_NO_TEXTURE.
uint32_t olx_texture_table_resolve(const olx_texture_table *table, uint32_t number);

void olx_texture_table_free(olx_texture_table *table);

#endif
