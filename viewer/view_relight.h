// Indirect light that follows the lights: a relighter beside the images, and uploads of its maps to the device.
#ifndef OCTALUX_VIEW_RELIGHT_H
#define OCTALUX_VIEW_RELIGHT_H

#include "gpu_device.h"
#include "view_state.h"

typedef struct view_relight view_relight;

// Creates a relighter. In step, a frame of the relighter runs for every image, so that scripts are reproducible.
// Otherwise frames run on a separate thread, and images do not wait for them. `uploaded` is `field` on the device.
// Returns NULL on failure, with a message in device->problem.
view_relight *view_relight_create(gpu_device *device, const olx_scene *scene, const olx_field *field,
                                  olx_vulkan_field *uploaded, bool in_step);
// Destroys the relighter. No copy may be pending. NULL is allowed.
void view_relight_destroy(view_relight *relight);

// Sets the lights from the next frame on.
void view_relight_lights(view_relight *relight, const view_lights *lights);

// Records uploads of the last frame's changes, and starts the next frame, before an image seen from `eye`. *times
// receives the costs of both. Returns false with a message in device->problem.
bool view_relight_record(gpu_device *device, view_relight *relight, olx_vec3 eye, VkCommandBuffer commands,
                         view_relight_times *times);

#endif
