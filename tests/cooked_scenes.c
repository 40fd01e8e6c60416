// Writes a scene that uses every feature of cooked files, and gives tests access to the bytes and checksums of a cooked
// file.
#include "cooked_scenes.h"

#include "gltf_maker.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char description[] =
    "{\"model\": \"square.obj\", \"unknown\": 1, \"models\": [{\"path\": \"rich.gltf\", \"translate\": [3, 0, 0]}],\n"
    "\"cameras\": [{\"name\": \"first\", \"eye\": [0, 0, 5], \"target\": [0, 1, 0], \"fov_y_degrees\": 50},\n"
    "{\"name\": \"second\", \"eye\": [1, 2, 3], \"target\": [0, 0, 0], \"up\": [0, 0, 1]}],\n"
    "\"lights\": [{\"type\": \"sun\", \"direction\": [0, -1, 0.2], \"irradiance\": [10, 9, 8]},\n"
    "{\"type\": \"rect\", \"center\": [0, 2, 0], \"edge_u\": [1, 0, 0], \"edge_v\": [0, 0, 1], \"radiance\": [17, 12, "
    "4]},\n"
    "{\"type\": \"point\", \"position\": [0, 2, 0], \"intensity\": [5, 5, 5]},\n"
    "{\"type\": \"spot\", \"position\": [0, 2, 0], \"direction\": [0, -1, 0], \"intensity\": [9, 8, 7]}],\n"
    "\"environment\": {\"image\": \"sky.hdr\", \"rotation_degrees\": 30, \"gain\": 2},\n"
    "\"materials\": {\"square\": {\"roughness\": 0.2, \"metallic\": 0.5, \"emission\": [0, 1, 0]}},\n"
    "\"probes\": {\"min\": [-1, -1, -1], \"max\": [1, 1, 1], \"grid\": [4, 3, 2], \"playable\": {\"min\": [-2, 0, -2], "
    "\"max\": [2, 2, 2]},\n\"pinned\": [[0, 1, 0], [1, 0, 0.5]], \"forbidden\": [{\"min\": [0, 0, 0], \"max\": [1, 1, "
    "1]}], \"min_distance\": 0.1}}";

// Writes a triangle with every attribute that vertices may have.
static void write_rich(const scene_folder *folder) {
  const float corners[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0}, normals[9] = {0, 0, 1, 0, 0, 1, 0, 0, 1};
  const float uvs[6] = {0, 1, 1, 1, 0, 0}, colors[12] = {1, 0, 0, 1, 0, 1, 0, 0.5f, 0, 0, 1, 1};
  const float tangents[12] = {1, 0, 0, 1, 0, 1, 0, -1, 1, 0, 0, 1};
  gltf_maker m = {0};
  gltf_add(&m, corners, sizeof corners, 3, GLTF_FLOAT, "VEC3", false);
  gltf_add(&m, normals, sizeof normals, 3, GLTF_FLOAT, "VEC3", false);
  gltf_add(&m, uvs, sizeof uvs, 3, GLTF_FLOAT, "VEC2", false);
  gltf_add(&m, colors, sizeof colors, 3, GLTF_FLOAT, "VEC4", false);
  gltf_add(&m, tangents, sizeof tangents, 3, GLTF_FLOAT, "VEC4", false);
  char *text = gltf_maker_text(&m,
                               "{\"attributes\": {\"POSITION\": 0, \"NORMAL\": 1, \"TEXCOORD_0\": 2, \"COLOR_0\": 3, "
                               "\"TANGENT\": 4}, \"material\": 0}",
                               "[{\"mesh\": 0}]",
                               ", \"materials\": [{\"name\": \"rich\", \"pbrMetallicRoughness\": "
                               "{\"baseColorTexture\": {\"index\": 0}}, \"normalTexture\": "
                               "{\"index\": 0, \"extensions\": {\"KHR_texture_transform\": {\"scale\": [2, 2]}}}}], "
                               "\"textures\": [{\"source\": 0}], "
                               "\"images\": [{\"uri\": \"four.tga\"}]",
                               false);
  scene_folder_write_text(folder, "rich.gltf", text);
  free(text);
}

const char *cooked_scenes_everything(const scene_folder *folder) {
  uint8_t tga[34], hdr[256];
  scene_folder_write_text(folder, "square.obj", scene_files_obj);
  scene_folder_write_text(folder, "square.mtl",
                          "newmtl square\nNs 100\nKd 0.5 0.25 0.125\nKs 0.1 0.1 0.1\nKe 1 2 3\nmap_Kd four.tga\nmap_d "
                          "four.tga\nmap_bump -bm 0.5 four.tga\n");
  scene_folder_write(folder, "four.tga", tga, scene_files_tga(tga));
  write_rich(folder);
  const int header = snprintf((char *)hdr, sizeof hdr, "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4 +X 4\n");
  for (int i = 0; i < 64; ++i) hdr[header + i] = (uint8_t)(i % 4 == 3 ? 130 : i * 4);
  scene_folder_write(folder, "sky.hdr", hdr, (size_t)header + 64);
  return scene_folder_write_text(folder, "everything.json", description);
}

cooked_bytes cooked_bytes_read(const char *path) {
  cooked_bytes file = {0};
  FILE *stream = fopen(path, "rb");
  if (!stream || fseek(stream, 0, SEEK_END) != 0) abort();
  file.size_bytes = (size_t)ftell(stream);
  rewind(stream);
  file.bytes = aligned_alloc(OLX_CHUNK_ALIGNMENT, olx_align_chunk(file.size_bytes));
  if (!file.bytes || fread(file.bytes, 1, file.size_bytes, stream) != file.size_bytes) abort();
  fclose(stream);
  return file;
}

void cooked_bytes_free(cooked_bytes *file) {
  free(file->bytes);
  *file = (cooked_bytes){0};
}

static olx_file_chunk *table_of(cooked_bytes file) { return (void *)(file.bytes + sizeof(olx_file_header)); }

static uint32_t chunks_inside(cooked_bytes file) {
  if (file.size_bytes < sizeof(olx_file_header)) return 0;
  const size_t fit = (file.size_bytes - sizeof(olx_file_header)) / sizeof(olx_file_chunk);
  const olx_file_header *header = (const void *)file.bytes;
  return header->chunk_count < fit ? header->chunk_count : (uint32_t)fit;
}

cooked_bytes cooked_bytes_chunk(cooked_bytes file, uint32_t index) {
  if (index >= chunks_inside(file)) return (cooked_bytes){0};
  const olx_file_chunk *chunk = &table_of(file)[index];
  if (chunk->offset > file.size_bytes || chunk->size_bytes > file.size_bytes - chunk->offset ||
      chunk->offset % OLX_CHUNK_ALIGNMENT != 0) {
    return (cooked_bytes){0};
  }
  return (cooked_bytes){file.bytes + chunk->offset, chunk->size_bytes};
}

void cooked_bytes_seal(cooked_bytes file) {
  if (file.size_bytes < sizeof(olx_file_header)) return;
  olx_file_header *header = (void *)file.bytes;
  const uint32_t count = chunks_inside(file);
  for (uint32_t i = 0; i < count; i++) {
    const cooked_bytes chunk = cooked_bytes_chunk(file, i);
    if (chunk.bytes) table_of(file)[i].hash = olx_content_hash(chunk.bytes, chunk.size_bytes);
  }
  header->table_hash = olx_content_hash(table_of(file), count * sizeof(olx_file_chunk));
  header->header_hash = olx_content_hash(header, offsetof(olx_file_header, header_hash));
}
