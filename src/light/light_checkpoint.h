// Light between two bounces, which is kept so that an interrupted solution goes on from there.
#ifndef OLX_LIGHT_LIGHT_CHECKPOINT_H
#define OLX_LIGHT_LIGHT_CHECKPOINT_H

#include "light/light_solution.h"

// Light between two bounces, stored when the last time was a second ago.
typedef struct olx_light_checkpoint {
  olx_scene_light *light;
  uint32_t round; // of the stage "bounce"
  double last;    // seconds of the clock
  olx_bounce_state state;
} olx_light_checkpoint;

// Begins to keep the bounces of a step: all of them with `all`, or else a few.
olx_bounce_keeper olx_light_checkpoint_begin(olx_light_checkpoint *checkpoint, olx_scene_light *light, bool all);

#endif
