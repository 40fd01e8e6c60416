// The input of the builders of selectors: the probes of a bake, and the scene around them.
#ifndef OLX_BAKE_SELECTOR_INPUT_H
#define OLX_BAKE_SELECTOR_INPUT_H

#include "core/parallel.h"
#include "field/field_data.h"
#include "scene/scene_data.h"

// Buried probes are left out by default, so only the tree of voronoi holds them, for lookups that keep them.
typedef struct olx_selector_input {
  const olx_scene *scene;
  const olx_vec3 *positions; // positions of the light field probes
  const uint8_t *flags;      // OLX_PROBE_*
  uint32_t count;
  uint32_t radiance_size; // texels along a side of a light field map
  uint64_t map_bytes;     // olx_light_field_map_bytes of all of them
  float distance_scale;   // metres
  uint32_t threads;       // the result must not depend on the number of threads
  olx_task *task;         // for cancellation; builders count no progress on it
} olx_selector_input;

#endif
