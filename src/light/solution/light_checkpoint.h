// Checkpoints of the light between two bounces, from which an interrupted solution continues.
#ifndef OLX_LIGHT_LIGHT_CHECKPOINT_H
#define OLX_LIGHT_LIGHT_CHECKPOINT_H

#include "light/solution/light_solution.h"

// A checkpoint, stored at most once a second.
typedef struct olx_light_checkpoint {
  olx_scene_light *light;
  uint32_t round; // round of the stage "bounce"
  double last;    // clock time of the last checkpoint, seconds
  olx_bounce_state state;
} olx_light_checkpoint;

// Begins checkpoints of a step: of all bounces with `all`, otherwise of a few.
olx_bounce_keeper olx_light_checkpoint_begin(olx_light_checkpoint *checkpoint, olx_scene_light *light, bool all);

#endif
