// The brightness of the image, and the exposure derived from it.
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
// Sets the images to use from now on; no pending work may use the previous ones.
void view_meter_attach(gpu_device *device, view_meter *meter, const frame_images *images);
// Records the measurement. Waits for the image; the host can read the result when the commands have run.
void view_meter_record(const gpu_device *device, const view_meter *meter, VkCommandBuffer commands);

// Returns the exposure after `seconds` of adaptation to the image that was metered last; INFINITY: full adaptation.
// Unchanged where the image is black.
float view_meter_follow(const view_meter *meter, float exposure, float seconds);

#endif
