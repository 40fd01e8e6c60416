// The two sets of probes of a bake: light field probes and irradiance probes.
#ifndef OLX_BAKE_PROBE_SETS_H
#define OLX_BAKE_PROBE_SETS_H

#include "scene/scene_data.h"

typedef struct olx_probe_list {
  uint32_t count;
  olx_vec3 *positions;
  uint8_t *flags; // OLX_PROBE_*
} olx_probe_list;

// Irradiance probes have a finer grid of their own; a field without probe light has none.
typedef struct olx_probe_sets {
  olx_probe_list light_field, irradiance;
} olx_probe_sets;

#endif
