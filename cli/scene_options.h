// The options for loading a scene, common to every command that loads one.
#ifndef OCTALUX_CLI_SCENE_OPTIONS_H
#define OCTALUX_CLI_SCENE_OPTIONS_H

#include "options.h"

#include <octalux/scene.h>

typedef struct scene_options {
  bool allow_outside;
  const char *import_limits; // "materials=20000,nodes=100000"; NULL: the defaults
  uint32_t instructions;     // olx_instructions
} scene_options;

// Options that fill a scene_options.
extern const option scene_loading_options[];

// Loads a scene. Returns EXIT_DONE, or the exit code after a line with the reason.
int load_scene(const char *command, const char *name, const scene_options *options, olx_scene **scene);

#endif
