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

// Rows of an option table that fill `s`.
#define SCENE_OPTION_ROWS(s)                                                                                           \
  {"--allow-outside",                                                                                                  \
   OPTION_FLAG,                                                                                                        \
   &(s).allow_outside,                                                                                                 \
   NULL,                                                                                                               \
   "read files that a model names wherever they are, not in its parent folder alone",                                  \
   0,                                                                                                                  \
   0},                                                                                                                 \
  {                                                                                                                    \
    "--import-limits", OPTION_TEXT, &(s).import_limits, "NAME=N,...",                                                  \
        "raise a limit of imports: triangles, texels, polygon_corners, materials, nodes", 0, 0                         \
  }

// Loads a scene. Returns EXIT_DONE, or the exit code after a line with the reason.
int load_scene(const char *command, const char *name, const scene_options *options, olx_scene **scene);

#endif
