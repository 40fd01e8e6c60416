// The gathers of a light field probe's texels as a unit of the store, so that after an edit of the scene their rays are
// reused where they hold (light/kept_gathers.h).
#ifndef OLX_BAKE_PROBE_GATHERS_H
#define OLX_BAKE_PROBE_GATHERS_H

#include "bake/bake_run.h"

enum { OLX_GATHER_SURFELS = 99 }; // round of the unit of their surfels

typedef struct olx_probe_gathers {
  olx_bake_run *run;
  olx_scene_inputs inputs;    // of the scene with its surfels
  olx_former_surfels earlier; // of another scene
  olx_gather_row *rows;       // of the probe that is captured; NULL: nothing is kept
  uint32_t row_count;
  void *former; // bytes of its gathers for another scene
} olx_probe_gathers;

// Prepares for the probes of a bake; without a work folder that is kept, nothing is kept.
olx_result olx_probe_gathers_create(olx_probe_gathers *gathers, olx_bake_run *run);
void olx_probe_gathers_free(olx_probe_gathers *gathers);
// Begins the capture of a probe, and reads its gathers for another scene.
void olx_probe_gathers_begin(olx_probe_gathers *gathers, uint32_t probe);
// Stores the gathers of a probe that was captured.
olx_result olx_probe_gathers_end(olx_probe_gathers *gathers, uint32_t probe);
// Stores the surfels at which gathers end, once those of all probes are stored.
olx_result olx_probe_gathers_finish(olx_probe_gathers *gathers);

#endif
