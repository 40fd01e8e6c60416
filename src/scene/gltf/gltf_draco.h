// KHR_draco_mesh_compression: primitives whose indices and attributes lie in one view that Draco compressed. Their
// accessors have no view; they say what the elements of each primitive that names them are decoded to.
#ifndef OLX_SCENE_GLTF_DRACO_H
#define OLX_SCENE_GLTF_DRACO_H

#include "scene/gltf/gltf_document.h"

// Marks the accessors whose elements are compressed: those that a primitive's extension names, and its indices. A
// primitive whose positions have a view has its uncompressed form beside the compressed one; that is read.
void olx_gltf_mark_draco(olx_gltf *gltf);

// Rejects a primitive whose elements cannot be decoded from its compressed view, before memory is allocated, or which
// names elements that only other primitives have.
olx_result olx_gltf_check_draco(const olx_gltf *gltf, uint32_t mesh, const cJSON *primitive);

// Decodes the elements of a primitive into its accessors, where they stay until another primitive that shares one of
// them is decoded. Does nothing for a primitive without compression.
olx_result olx_gltf_decode_draco(const olx_gltf *gltf, const cJSON *primitive);

#endif
