// Views that meshoptimizer compressed: EXT_meshopt_compression, also as KHR_meshopt_compression and
// MESHOPT_compression.
#ifndef OLX_SCENE_GLTF_MESHOPT_H
#define OLX_SCENE_GLTF_MESHOPT_H

#include "scene/gltf_document.h"

// The extension of a view or a buffer, by any of its names; NULL without it.
const cJSON *olx_gltf_meshopt_of(const cJSON *element);

// Refuse modes, filters and sizes that a compressed view of `size_bytes` cannot have, before memory is spent on it.
// *stride becomes that of what it decodes to.
olx_result olx_gltf_meshopt_check(const olx_gltf *gltf, uint32_t view, const cJSON *compressed, uint64_t size_bytes,
                                  uint64_t *stride);

// Bytes that a compressed view decodes to.
uint64_t olx_gltf_meshopt_size(const cJSON *compressed);

// Decode the bytes of a view that has been checked. On success *decoded, olx_gltf_meshopt_size bytes, is the caller's
// to give to olx_release.
olx_result olx_gltf_meshopt_decode(const olx_gltf *gltf, uint32_t view, const cJSON *compressed, olx_gltf_bytes bytes,
                                   uint8_t **decoded);

#endif
