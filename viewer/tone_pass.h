// Tone-maps linear radiance to the displayed image, with the curve of `octalux render`'s .png files.
#ifndef OCTALUX_VIEWER_TONE_PASS_H
#define OCTALUX_VIEWER_TONE_PASS_H

#include "frame_images.h"
#include "gpu_pipeline.h"

typedef struct tone_pass {
  gpu_set set;
  gpu_compute compute;
} tone_pass;

bool tone_pass_create(gpu_device *device, tone_pass *pass);
void tone_pass_destroy(gpu_device *device, tone_pass *pass);
// Sets the images to use from now on; no pending work may use the previous ones. `shown` is one of the images of format
// R16G16B16A16_SFLOAT: FRAME_COLOR, or another for inspection.
void tone_pass_attach(gpu_device *device, tone_pass *pass, const frame_images *images, frame_image shown);

// Records the pass. Waits for compute recorded before. Afterwards the display image may be copied, blitted, drawn over
// and sampled.
void tone_pass_record(const gpu_device *device, const tone_pass *pass, VkCommandBuffer commands,
                      const frame_images *images, float exposure);

#endif
