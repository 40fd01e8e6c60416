// Indirect light that follows the lights: a relighter beside the pictures, and the copies of its maps to the device.
#ifndef OCTALUX_VIEW_RELIGHT_H
#define OCTALUX_VIEW_RELIGHT_H

#include "gpu_device.h"
#include "view_state.h"

typedef struct view_relight view_relight;

// In step: a frame of the relighter for every picture, so that scripts always do the same. Else frames run on a thread
// of their own, and pictures do not wait for them. `uploaded` is `field` on the device. On failure NULL, with a message
// in device->problem.
view_relight *view_relight_create(gpu_device *device, const olx_scene *scene, const olx_field *field,
                                  olx_vulkan_field *uploaded, bool in_step);
// Nothing that copies may be pending. NULL is allowed.
void view_relight_destroy(view_relight *relight);

// The lights from the next frame on.
void view_relight_lights(view_relight *relight, const view_lights *lights);

// Before a picture seen from `eye`: record the copies of what the last frame changed, and let the next one begin.
// *times receives what both took and did. False with a message in device->problem.
bool view_relight_record(gpu_device *device, view_relight *relight, olx_vec3 eye, VkCommandBuffer commands,
                         view_relight_times *times);

#endif
