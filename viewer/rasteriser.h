// A scene and all passes that draw it, together: what the viewer and the benchmark begin with.
//
// A frame: shadow_pass_record (once, or when something moved), gbuffer_pass_record, direct_pass_record, then Octalux's
// passes, then tone_pass_record.
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

// It points into itself: it must not be moved or copied.
bool rasteriser_create(gpu_device *device, const olx_scene_content *content, const lamp_settings *lamps, uint32_t width,
                       uint32_t height, rasteriser *raster);
void rasteriser_destroy(gpu_device *device, rasteriser *raster);

// Other images, of another size; nothing that uses them may be pending. On failure there are none, and it may be tried
// again.
bool rasteriser_resize(gpu_device *device, rasteriser *raster, uint32_t width, uint32_t height);

#endif
