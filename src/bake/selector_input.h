// What the builders of selectors work from: the probes of a bake, and the scene around them.
#ifndef OLX_BAKE_SELECTOR_INPUT_H
#define OLX_BAKE_SELECTOR_INPUT_H

#include "core/parallel.h"
#include "field/field_data.h"
#include "scene/scene_data.h"

enum { OLX_LIGHT_FIELD_TEXEL_BYTES = 8 }; // radiance, normal, distance

// Buried probes are never queried, so no structure needs to name them.
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

#endif
