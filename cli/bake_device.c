// Opens a Vulkan device for a bake that rasterises what its probes see, or says why there is none.
#include "bake_device.h"

#include "options.h"

#ifdef OLX_HAS_VULKAN

#include "cube_raster.h"

#include <stdlib.h>

struct bake_device {
  gpu_device device;
  cube_raster *raster;
  bool open;
};

int open_bake_device(const olx_scene *scene, bool validate, olx_bake_settings *settings, bake_device **device) {
  bake_device *b = *device = calloc(1, sizeof *b);
  if (!b) return failure("bake", "out of memory");
  const gpu_device_options options = {.validate = validate, .device = UINT32_MAX};
  b->open = gpu_device_open(&options, &b->device);
  if (!b->open || !cube_raster_create(&b->device, scene, &b->raster))
    return failure("bake", "--device vulkan: %s", b->device.problem);
  settings->raster = cube_raster_interface(b->raster);
  return EXIT_DONE;
}

void close_bake_device(bake_device *b) {
  if (!b) return;
  cube_raster_destroy(b->raster);
  if (b->open) gpu_device_close(&b->device);
  free(b);
}

#else

int open_bake_device(const olx_scene *scene, bool validate, olx_bake_settings *settings, bake_device **device) {
  (void)scene;
  (void)validate;
  (void)settings;
  *device = NULL;
  return failure("bake", "--device vulkan: this program was built without the Vulkan runtime");
}

void close_bake_device(bake_device *device) { (void)device; }

#endif
