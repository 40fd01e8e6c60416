// The textures a model asks for: each decoded once, all in parallel, and missing ones reported.
#ifndef OLX_SCENE_TEXTURE_TABLE_H
#define OLX_SCENE_TEXTURE_TABLE_H

#include "scene/name_index.h"
#include "scene/texture_file.h"

typedef struct olx_texture_request {
  char *path;       // for messages, and to read from when data is NULL
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
  olx_name_index paths; // of the requests
} olx_texture_table;

// Ask for a texture and get its number in the table. `path` is copied.
olx_result olx_texture_table_request(olx_texture_table *table, const char *path, const void *data, size_t size_bytes,
                                     olx_texture_use use, uint32_t *number);

// Decode everything and append it to the scene. Unreadable images become warnings; images with more texels than the
// scene's limit are refused before one is decoded.
olx_result olx_texture_table_load(olx_texture_table *table, const char *model_path, olx_scene *scene);

// The texture of the scene for a number of the table, or OLX_NO_TEXTURE for OLX_NO_TEXTURE.
uint32_t olx_texture_table_resolve(const olx_texture_table *table, uint32_t number);

void olx_texture_table_free(olx_texture_table *table);

#endif
