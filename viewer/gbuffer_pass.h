// Draws scenes into depth, normal, albedo and material, and what they emit into color. Surfaces are two-sided and may
// have alpha masks; which side is in front decides the normal's direction and who emits, as everywhere in Octalux.
#ifndef OCTALUX_VIEWER_GBUFFER_PASS_H
#define OCTALUX_VIEWER_GBUFFER_PASS_H

#include "frame_images.h"
#include "raster_view.h"
#include "scene_upload.h"

typedef struct gbuffer_pass {
  VkRenderPass render_pass;
  VkPipelineLayout layout;
  VkPipeline pipeline;
  VkFramebuffer framebuffer; // of the images it was made for
} gbuffer_pass;

// Creates the pass; `set_layout` is that of any scene, since all are alike.
bool gbuffer_pass_create(gpu_device *device, VkDescriptorSetLayout set_layout, gbuffer_pass *pass);
void gbuffer_pass_destroy(gpu_device *device, gbuffer_pass *pass);

// Draw into these images from now on; nothing that draws into the ones before may be pending. Call it after each
// frame_images_create.
bool gbuffer_pass_attach(gpu_device *device, gbuffer_pass *pass, const frame_images *images);

// Clears and draws. Waits for compute and transfers that were recorded before; compute that follows may read and write
// all images.
void gbuffer_pass_record(const gpu_device *device, const gbuffer_pass *pass, VkCommandBuffer commands,
                         const frame_images *images, const raster_view *view, const draw_item *items, uint32_t count);

#endif
