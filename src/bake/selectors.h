// The structures by which probes are found, built at bake time: one function a selector.
#ifndef OLX_BAKE_SELECTORS_H
#define OLX_BAKE_SELECTORS_H

#include "core/parallel.h"
#include "field/field_data.h"
#include "scene/scene_data.h"

enum { OLX_LIGHT_FIELD_TEXEL_BYTES = 8 }; // radiance, normal, distance

// What a builder may look at. Buried probes are never asked, so no structure needs to name them.
typedef struct olx_selector_input {
  const olx_scene *scene;
  const olx_vec3 *positions; // of the light field probes
  const uint8_t *flags;      // OLX_PROBE_*
  uint32_t count;
  uint32_t radiance_size; // texels along a side of a light field map
  uint64_t map_bytes;     // of all light field maps: what a structure's size is measured against
  float distance_scale;   // metres
  uint32_t threads;       // the result must not depend on it
  olx_task *task;         // to be cancelled by; no progress is counted on it
} olx_selector_input;

// On success *data is the caller's, to be given to olx_release. It lies in the file as it is, 64-byte aligned.
typedef olx_result (*olx_selector_builder)(const olx_selector_input *input, void **data, size_t *size_bytes);

// What was built, by olx_select.
typedef struct olx_selector_blobs {
  void *data[OLX_SELECT_STORED];
  size_t size_bytes[OLX_SELECT_STORED];
} olx_selector_blobs;

// A bit (1 << olx_select) for each selector that can be baked.
uint32_t olx_selectors_known(void);

// Build what `mask` names. The blobs are the caller's to free, also after a failure; begin with zeroes.
olx_result olx_selectors_build(const olx_selector_input *input, uint32_t mask, olx_selector_blobs *blobs);
void olx_selectors_free(olx_selector_blobs *blobs);

#endif
