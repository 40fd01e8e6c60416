// The bytes of a glTF file: its buffers, and the views of them, decoded where they are compressed.
#ifndef OLX_SCENE_GLTF_BUFFER_H
#define OLX_SCENE_GLTF_BUFFER_H

#include "scene/gltf_document.h"

struct olx_gltf_buffer {
  olx_gltf_bytes bytes;   // as many as byteLength says
  olx_mapped_file mapped; // a file of its own
  uint8_t *decoded;       // a data: URI
  bool fallback;          // for readers without meshopt, and so left unread
};

struct olx_gltf_view {
  olx_gltf_bytes bytes;    // of the file; once it is decoded, what it decodes to. Data is NULL until then
  uint64_t stride;         // between elements; 0 when they are packed
  const cJSON *compressed; // EXT_meshopt_compression, or NULL
  uint8_t *decoded;
};

// Open every buffer and check every view. A buffer's file is refused where olx_model_file_check refuses it.
olx_result olx_gltf_open_buffers(olx_gltf *gltf);
void olx_gltf_release_buffers(olx_gltf *gltf);

// The bytes of a view, which are decoded when they are first asked for.
olx_result olx_gltf_view_bytes(const olx_gltf *gltf, uint32_t view, olx_gltf_bytes *bytes);

// Images that lie in views must not share bytes, so that a small file does not hold many of them.
olx_result olx_gltf_check_images(const olx_gltf *gltf);

#endif
