// The command line of `octalux view`.
#ifndef OCTALUX_VIEW_OPTIONS_H
#define OCTALUX_VIEW_OPTIONS_H

#include "scene_options.h"
#include "view_state.h"

typedef struct view_options {
  const char *scene, *field, *camera, *screenshot, *script, *pick, *object;
  scene_options loading;
  uint32_t size[2];
  uint32_t frames; // 0: until the window is closed
  bool offscreen, validate, panel, no_wait, relight;
  view_state state;    // to begin with; what depends on the scene is filled later
  float pick_pixel[2]; // when pick is given
} view_options;

// True when the program should go on; else *exit_code is what to leave with.
bool view_options_read(int argc, char **argv, view_options *options, int *exit_code);

#endif
