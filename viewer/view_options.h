// The command line of `octalux view`.
#ifndef OCTALUX_VIEW_OPTIONS_H
#define OCTALUX_VIEW_OPTIONS_H

#include "scene_options.h"
#include "view_state.h"

typedef struct view_options {
  const char *scene, *field, *camera, *screenshot, *script, *pick, *object;
  scene_options loading;
  uint32_t size[2];
  uint32_t frames;                  // 0: until the window is closed
  uint32_t scale_percent, emitters; // as given; `state` has what follows from them
  bool offscreen, validate, panel, no_wait, relight, json;
  view_state state;    // initial state; values that depend on the scene are set later
  float pick_pixel[2]; // valid when pick is given
} view_options;

// Parses the command line. Returns true when the program should continue; otherwise *exit_code is the exit code.
bool view_options_read(int argc, char **argv, view_options *options, int *exit_code);

#endif
