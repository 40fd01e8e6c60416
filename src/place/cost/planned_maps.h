// The maps that a bake is going to make, for estimates of what they take.
#ifndef OLX_PLACE_PLANNED_MAPS_H
#define OLX_PLACE_PLANNED_MAPS_H

#include "scene/scene_data.h"

// The light field maps of a field that is not baked yet.
typedef struct olx_planned_maps {
  const olx_scene *scene;
  const olx_vec3 *positions; // of the probes; NULL where they are those of `grid`
  const olx_grid *grid;
  uint32_t count, size;                           // number of probes, and texels along a side of a map
  uint32_t samples, light_samples, bounces, seed; // as in olx_bake_settings
} olx_planned_maps;

#endif
