// A scene and all passes that draw it, for the viewer and the benchmark.
//
// A frame consists of shadow_pass_record (once, or when something moved), gbuffer_pass_record, direct_pass_record, then
// Octalux's passes, then tone_pass_record.
#ifndef OCTALUX_VIEWER_RASTERISER_H
#define OCTALUX_VIEWER_RASTERISER_H

#include "direct_pass.h"
#include "gbuffer_pass.h"
#include "shadow_pass.h"
#include "tone_pass.h"

typedef struct rasteriser {
  gpu_scene scene;
  frame_images images;
  gbuffer_pass gbuffer;
  shadow_pass shadows;
  direct_pass direct;
  tone_pass tone;
} rasteriser;

// Creates the rasteriser. It points into itself, so that it must not be moved or copied.
bool rasteriser_create(gpu_device *device, const olx_scene_content *content, const lamp_settings *lamps, uint32_t width,
                       uint32_t height, rasteriser *raster);
void rasteriser_destroy(gpu_device *device, rasteriser *raster);

// Replaces the images by others of another size; no pending work may use them. On failure there are no images, and the
// call may be repeated.
bool rasteriser_resize(gpu_device *device, rasteriser *raster, uint32_t width, uint32_t height);

#endif
