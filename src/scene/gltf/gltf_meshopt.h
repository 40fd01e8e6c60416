// Views compressed by meshoptimizer: EXT_meshopt_compression, also under the names KHR_meshopt_compression and
// MESHOPT_compression.
#ifndef OLX_SCENE_GLTF_MESHOPT_H
#define OLX_SCENE_GLTF_MESHOPT_H

#include "scene/gltf/gltf_document.h"

// Returns the extension of a view or a buffer, under any of its names; NULL without it.
const cJSON *olx_gltf_meshopt_of(const cJSON *element);

// Rejects modes, filters and sizes that are invalid for a compressed view of `size_bytes`, before memory is allocated.
// *stride receives that of the decompressed elements.
olx_result olx_gltf_meshopt_check(const olx_gltf *gltf, uint32_t view, const cJSON *compressed, uint64_t size_bytes,
                                  uint64_t *stride);

// Returns the size of a view after decompression, in bytes.
uint64_t olx_gltf_meshopt_size(const cJSON *compressed);

// Decompresses a view that has been checked. On success the caller releases *decoded, olx_gltf_meshopt_size bytes, with
// olx_release.
olx_result olx_gltf_meshopt_decode(const olx_gltf *gltf, uint32_t view, const cJSON *compressed, olx_gltf_bytes bytes,
                                   uint8_t **decoded);

#endif
