// Opens the device of `bake --device vulkan` and hands it to the bake.
#ifndef OCTALUX_CLI_BAKE_DEVICE_H
#define OCTALUX_CLI_BAKE_DEVICE_H

#include <octalux/bake.h>

typedef struct bake_device bake_device;

// Opens the best device and uploads the scene's triangles; settings->raster then rasterises with it. Returns an exit
// code, after a message where it is not EXIT_DONE. The caller closes *device, also after a failure.
int open_bake_device(const olx_scene *scene, bool validate, olx_bake_settings *settings, bake_device **device);
void close_bake_device(bake_device *device); // NULL is allowed

#endif
