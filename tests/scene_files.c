// Writes small OBJ, glTF, GLB and image files into a temporary folder for tests of imports.
#include "scene_files.h"

#include "data_uris.h"
#include "gltf_maker.h"

#include <octalux/base.h>

#include <ftw.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

bool scene_folder_create(scene_folder *folder) {
  const char *base = getenv("TMPDIR");
  snprintf(folder->path, sizeof folder->path, "%s/octalux-scene-XXXXXX", base && *base ? base : "/tmp");
  return mkdtemp(folder->path) != NULL;
}

static int remove_entry(const char *path, const struct stat *about, int kind, struct FTW *where) {
  (void)about, (void)kind, (void)where;
  return remove(path);
}

void scene_folder_remove(const scene_folder *folder) { nftw(folder->path, remove_entry, 16, FTW_DEPTH | FTW_PHYS); }

static void discard_message(void *user, olx_log_level level, const char *message) {
  (void)user, (void)level, (void)message;
}

int scene_folder_set_up(void **state) {
  scene_folder *folder = malloc(sizeof *folder);
  *state = folder;
  olx_set_hooks(&(olx_hooks){.log = discard_message});
  return folder && scene_folder_create(folder) ? 0 : -1;
}

int scene_folder_tear_down(void **state) {
  scene_folder_remove(*state);
  free(*state);
  return 0;
}

const char *scene_folder_write(const scene_folder *folder, const char *name, const void *data, size_t size_bytes) {
  static _Thread_local char paths[4][600];
  static _Thread_local unsigned next;
  char *path = paths[next++ % 4];
  snprintf(path, sizeof paths[0], "%s/%s", folder->path, name);
  FILE *file = fopen(path, "wb");
  if (!file || fwrite(data, 1, size_bytes, file) != size_bytes || fclose(file) != 0) {
    perror(path);
    abort();
  }
  return path;
}

const char *scene_folder_write_text(const scene_folder *folder, const char *name, const char *text) {
  return scene_folder_write(folder, name, text, strlen(text));
}

#define SQUARE_BYTES 140

// Fills a buffer with four vertices of position, normal and uv, then six indices.
static void square_buffer(uint8_t bytes[SQUARE_BYTES]) {
  const float vertices[4][8] = {
      {0, 0, 0, 0, 0, 1, 0, 1}, {1, 0, 0, 0, 0, 1, 1, 1}, {1, 1, 0, 0, 0, 1, 1, 0}, {0, 1, 0, 0, 0, 1, 0, 0}};
  const uint16_t indices[6] = {0, 1, 2, 0, 2, 3};
  memcpy(bytes, vertices, sizeof vertices);
  memcpy(bytes + sizeof vertices, indices, sizeof indices);
}

char *scene_files_gltf(const char *materials, int mesh_material, const char *nodes, const char *more, bool binary) {
  uint8_t bytes[SQUARE_BYTES];
  char base64[SQUARE_BYTES * 2], uri[SQUARE_BYTES * 2 + 64] = "", material[32] = "";
  square_buffer(bytes);
  encode_base64(bytes, sizeof bytes, base64);
  if (!binary) snprintf(uri, sizeof uri, "\"uri\": \"data:application/octet-stream;base64,%s\", ", base64);
  if (mesh_material >= 0) snprintf(material, sizeof material, ", \"material\": %d", mesh_material);
  const size_t capacity = 4096 + strlen(materials) + strlen(nodes) + strlen(more);
  char *text = malloc(capacity);
  snprintf(text, capacity,
           "{\"asset\": {\"version\": \"2.0\"}, \"scene\": 0, \"scenes\": [{\"nodes\": [0]}], \"nodes\": %s,\n"
           "\"materials\": %s,\n"
           "\"meshes\": [{\"name\": \"square\", \"primitives\": [{\"attributes\": {\"POSITION\": 0, \"NORMAL\": 1, "
           "\"TEXCOORD_0\": 2}, \"indices\": 3%s}]}],\n"
           "\"accessors\": [\n"
           "{\"bufferView\": 0, \"componentType\": 5126, \"count\": 4, \"type\": \"VEC3\", \"min\": [0, 0, 0], "
           "\"max\": [1, 1, 0]},\n"
           "{\"bufferView\": 0, \"byteOffset\": 12, \"componentType\": 5126, \"count\": 4, \"type\": \"VEC3\"},\n"
           "{\"bufferView\": 0, \"byteOffset\": 24, \"componentType\": 5126, \"count\": 4, \"type\": \"VEC2\"},\n"
           "{\"bufferView\": 1, \"componentType\": 5123, \"count\": 6, \"type\": \"SCALAR\"}],\n"
           "\"bufferViews\": [{\"buffer\": 0, \"byteLength\": 128, \"byteStride\": 32}, "
           "{\"buffer\": 0, \"byteOffset\": 128, \"byteLength\": 12}],\n"
           "\"buffers\": [{%s\"byteLength\": 140}]%s}",
           nodes, materials, material, uri, more);
  return text;
}

size_t scene_files_glb(const char *materials, int mesh_material, const char *nodes, const char *more, uint8_t **data) {
  char *text = scene_files_gltf(materials, mesh_material, nodes, more, true);
  uint8_t bytes[SQUARE_BYTES];
  square_buffer(bytes);
  const size_t size_bytes = gltf_make_glb(text, strlen(text), bytes, sizeof bytes, data);
  free(text);
  return size_bytes;
}

size_t scene_files_tga(uint8_t data[34]) {
  // The TGA is uncompressed true colour: 32 bits, rows from the top, BGRA.
  const uint8_t file[34] = {0,    0, 2, 0,   0,   0, 0,   0, 0,   0,   0, 0, 2,   0,   2,   0,   32,
                            0x28, 0, 0, 255, 255, 0, 255, 0, 255, 255, 0, 0, 255, 255, 255, 255, 0};
  memcpy(data, file, sizeof file);
  return sizeof file;
}

const char scene_files_obj[] = "mtllib square.mtl\n"
                               "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"
                               "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
                               "vn 0 0 1\n"
                               "usemtl square\n"
                               "f 1/1/1 2/2/1 3/3/1 4/4/1\n";

bool scene_files_real(const char *name, char *path, size_t size_bytes) {
  const char *folders = getenv("OCTALUX_SCENES");
  if (!folders || !*folders) folders = OLX_SOURCE_DIR "/../shared/scenes";
  snprintf(path, size_bytes, "%.*s/%s", (int)strcspn(folders, ":"), folders, name);
  return access(path, R_OK) == 0;
}
