// How bright the picture is, and the exposure that follows from it.
#ifndef OCTALUX_VIEW_METER_H
#define OCTALUX_VIEW_METER_H

#include "frame_images.h"
#include "gpu_pipeline.h"

typedef struct view_meter {
  gpu_set set;
  gpu_compute compute;
  gpu_buffer metered;
} view_meter;

bool view_meter_create(gpu_device *device, view_meter *meter);
void view_meter_destroy(gpu_device *device, view_meter *meter);
// Use these images from now on; nothing that uses the ones before may be pending.
void view_meter_attach(gpu_device *device, view_meter *meter, const frame_images *images);
// Waits for the picture, and is there for the host when the commands have run.
void view_meter_record(const gpu_device *device, const view_meter *meter, VkCommandBuffer commands);

// The exposure after `seconds` of getting used to the picture that was metered last; INFINITY: used to it at once. It
// is as it was where the picture is black.
float view_meter_follow(const view_meter *meter, float exposure, float seconds);

#endif
