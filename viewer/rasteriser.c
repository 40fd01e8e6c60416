// Creates and destroys the scene on the device together with all passes that draw it.
#include "rasteriser.h"

bool rasteriser_create(gpu_device *d, const olx_scene_content *content, const lamp_settings *lamps, uint32_t width,
                       uint32_t height, rasteriser *raster) {
  *raster = (rasteriser){.images = {.width = 0}};
  if (gpu_scene_create(d, content, &raster->scene) &&
      gbuffer_pass_create(d, raster->scene.set_layout, &raster->gbuffer) &&
      shadow_pass_create(d, raster->scene.set_layout, content, lamps, &raster->shadows) &&
      direct_pass_create(d, content, &raster->shadows, &raster->direct) && tone_pass_create(d, &raster->tone) &&
      rasteriser_resize(d, raster, width, height)) {
    return true;
  }
  rasteriser_destroy(d, raster);
  return false;
}

void rasteriser_destroy(gpu_device *d, rasteriser *raster) {
  frame_images_destroy(d, &raster->images);
  tone_pass_destroy(d, &raster->tone);
  direct_pass_destroy(d, &raster->direct);
  shadow_pass_destroy(d, &raster->shadows);
  gbuffer_pass_destroy(d, &raster->gbuffer);
  gpu_scene_destroy(d, &raster->scene);
}

bool rasteriser_resize(gpu_device *d, rasteriser *raster, uint32_t width, uint32_t height) {
  frame_images_destroy(d, &raster->images);
  if (!frame_images_create(d, width, height, &raster->images)) return false;
  if (!gbuffer_pass_attach(d, &raster->gbuffer, &raster->images)) {
    frame_images_destroy(d, &raster->images);
    return false;
  }
  direct_pass_attach(d, &raster->direct, &raster->images);
  tone_pass_attach(d, &raster->tone, &raster->images, FRAME_COLOR);
  return true;
}
