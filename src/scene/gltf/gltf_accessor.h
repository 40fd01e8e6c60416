// Accessors: arrays of numbers in the views of a glTF file, packed, interleaved, normalized or sparse.
#ifndef OLX_SCENE_GLTF_ACCESSOR_H
#define OLX_SCENE_GLTF_ACCESSOR_H

#include "scene/gltf/gltf_document.h"

typedef enum olx_gltf_component {
  OLX_GLTF_INT8 = 5120,
  OLX_GLTF_UINT8 = 5121,
  OLX_GLTF_INT16 = 5122,
  OLX_GLTF_UINT16 = 5123,
  OLX_GLTF_UINT32 = 5125,
  OLX_GLTF_FLOAT = 5126
} olx_gltf_component;

// Sparse elements, which replace some of an accessor's own.
typedef struct olx_gltf_sparse {
  uint64_t count; // 0: none
  uint32_t index_view, value_view;
  uint64_t index_offset, value_offset;
  olx_gltf_component index_type;
} olx_gltf_sparse;

struct olx_gltf_accessor {
  uint32_t view;            // OLX_GLTF_NONE: all elements are compressed, or 0 unless replaced
  bool compressed;          // each primitive has elements of its own in its Draco stream
  uint8_t *decoded;         // packed elements of the primitive that was decoded last
  const cJSON *decoded_for; // the primitive that was decoded last
  olx_gltf_component type;
  uint32_t components; // components of an element
  bool normalized;     // integers represent 0 to 1, or -1 to 1
  uint64_t offset, stride, count;
  olx_gltf_sparse sparse;
};

// Makes the accessors, of which nothing is known yet.
olx_result olx_gltf_make_accessors(olx_gltf *gltf);
// Reads and checks all accessors: their types, and that they lie within their views. Those with compressed elements
// must have been marked (gltf_draco.h).
olx_result olx_gltf_open_accessors(olx_gltf *gltf);
void olx_gltf_release_accessors(olx_gltf *gltf);

// Reads the first `components` numbers of every element, `components` apart in `numbers`; where an element has fewer,
// the others are unchanged. The caller provides room for all.
olx_result olx_gltf_read_floats(const olx_gltf *gltf, uint32_t accessor, uint32_t components, float *numbers);
// Reads the first `count` elements in the same way, of an accessor that has as many, and none that are sparse.
olx_result olx_gltf_read_first_floats(const olx_gltf *gltf, uint32_t accessor, uint64_t count, uint32_t components,
                                      float *numbers);
// Reads an accessor of unsigned integers.
olx_result olx_gltf_read_indices(const olx_gltf *gltf, uint32_t accessor, uint32_t *indices);

#endif
