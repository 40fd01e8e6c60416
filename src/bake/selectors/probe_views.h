// Coarse maps of what probes see, for builders that query many times which probe sees which point.
#ifndef OLX_BAKE_PROBE_VIEWS_H
#define OLX_BAKE_PROBE_VIEWS_H

#include "bake/selectors/selector_input.h"

// Octahedral maps of distance and normal, n x n texels without border, from rays through texel centres.
typedef struct olx_probe_views {
  const olx_selector_input *input;
  uint32_t n;
  float *distance;  // metres, infinite for the sky; n * n per probe
  uint16_t *normal; // olx_normal_pack, towards the probe
} olx_probe_views;

// Creates maps as large as the light field maps, but of at most 128 texels along a side, and smaller ones where there
// are so many probes that memory would grow too large. The caller frees them, also after a failure.
olx_result olx_probe_views_create(const olx_selector_input *input, olx_probe_views *views);
void olx_probe_views_free(olx_probe_views *views);

// Returns whether a probe sees a point: whether it lies in front of the plane of the surface in that direction, or
// behind it by less than a texel's footprint.
bool olx_view_sees(const olx_probe_views *views, uint32_t probe, olx_vec3 point);

#endif
