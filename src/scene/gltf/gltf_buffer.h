// The bytes of a glTF file: its buffers and views, decompressed where necessary.
#ifndef OLX_SCENE_GLTF_BUFFER_H
#define OLX_SCENE_GLTF_BUFFER_H

#include "scene/gltf/gltf_document.h"

struct olx_gltf_buffer {
  olx_gltf_bytes bytes;   // byteLength bytes
  olx_mapped_file mapped; // mapping of the buffer's file
  uint8_t *decoded;       // decoded data: URI
  bool fallback;          // only for readers without meshopt, so not read
};

struct olx_gltf_view {
  olx_gltf_bytes bytes;    // bytes in the file, or the decompressed bytes; data is NULL until then
  uint64_t stride;         // bytes between elements; 0 when they are packed
  const cJSON *compressed; // EXT_meshopt_compression, or NULL
  uint8_t *decoded;
};

// Opens every buffer and checks every view. Files that olx_model_file_check rejects are not read.
olx_result olx_gltf_open_buffers(olx_gltf *gltf);
void olx_gltf_release_buffers(olx_gltf *gltf);

// Finds the bytes of a view, which are decompressed on first use.
olx_result olx_gltf_view_bytes(const olx_gltf *gltf, uint32_t view, olx_gltf_bytes *bytes);

// Rejects images whose views share bytes, so that a small file cannot contain many large images.
olx_result olx_gltf_check_images(const olx_gltf *gltf);

#endif
