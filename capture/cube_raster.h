// Rasterises cube maps around light field probes on a Vulkan device, for a bake (octalux/bake.h, olx_bake_raster).
#ifndef OCTALUX_CAPTURE_CUBE_RASTER_H
#define OCTALUX_CAPTURE_CUBE_RASTER_H

#include "gpu_device.h"

#include <octalux/bake.h>

typedef struct cube_raster cube_raster;

// Uploads the triangles and alpha masks of a scene to a device with graphics, which it uses until it is destroyed; the
// scene is not needed afterwards. On failure device->problem says why.
bool cube_raster_create(gpu_device *device, const olx_scene *scene, cube_raster **raster);
void cube_raster_destroy(cube_raster *raster); // NULL is allowed

// Returns what olx_bake_settings.raster takes. It is the raster's, and valid as long as it.
const olx_bake_raster *cube_raster_interface(const cube_raster *raster);

#endif
