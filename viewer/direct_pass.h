// Adds the lamps' light, with shadows, to color, and the environment behind all surfaces. The image then holds what
// `octalux render` calls emission and direct light.
#ifndef OCTALUX_VIEWER_DIRECT_PASS_H
#define OCTALUX_VIEWER_DIRECT_PASS_H

#include "frame_images.h"
#include "gpu_pipeline.h"
#include "raster_view.h"
#include "shadow_pass.h"

typedef struct direct_pass {
  const shadow_pass *shadows;
  gpu_image sky; // the environment's image; a single texel when it has none
  gpu_buffer environment;
  VkSampler shadow_sampler, plain_sampler;
  gpu_set set;
  gpu_compute compute;
} direct_pass;

// Creates the pass; `shadows` must outlive it.
bool direct_pass_create(gpu_device *device, const olx_scene_content *content, const shadow_pass *shadows,
                        direct_pass *pass);
void direct_pass_destroy(gpu_device *device, direct_pass *pass);

// Sets the images to light from now on; no pending work may use the previous ones.
void direct_pass_attach(gpu_device *device, direct_pass *pass, const frame_images *images);

// The light that the pass adds; without any flag the pass does nothing. The last flag is for renderers whose rays hit
// the lamps with an extent.
enum { DIRECT_LAMPS = 1, DIRECT_SKY = 2, DIRECT_WITHOUT_EXTENT = 4 };

// Records the pass, which follows the G-buffer pass. Later compute may read and write color.
void direct_pass_record(const gpu_device *device, const direct_pass *pass, VkCommandBuffer commands,
                        const frame_images *images, const raster_view *view, uint32_t add);

#endif
