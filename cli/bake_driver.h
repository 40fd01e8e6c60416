// `octalux bake` with another way to run the bake that its options describe, for programs that distribute it.
#ifndef OCTALUX_CLI_BAKE_DRIVER_H
#define OCTALUX_CLI_BAKE_DRIVER_H

#include <octalux/bake.h>

// The bake that the options describe, ready to run. All of it lives as long as the call that receives it.
typedef struct driven_bake {
  const olx_scene *scene;
  olx_bake_settings settings; // with a work folder
  const char *path;           // of the field
  bool shows_progress;        // in a line on standard error
} driven_bake;

typedef struct bake_driver {
  const char *name, *summary, *example;
  // Called when the options and files were checked, before the scene is loaded. Returns whether to go on.
  bool (*checked)(void *user);
  // Runs all parts of the bake; may change the settings. Returns EXIT_DONE when all units are stored and only the file
  // remains to be made of them. This process makes it, unless *collects is cleared because another process does.
  int (*run)(void *user, driven_bake *bake, bool *collects);
  void *user;
} bake_driver;

// Runs `octalux bake`, by the driver; NULL: as one process.
int bake_with(const bake_driver *driver, int argc, char **argv);

#endif
