// Draws scenes into depth, normal, albedo and material, and their emission into color. Surfaces are two-sided and may
// have alpha masks; the side that is in front determines the normal's direction and whether it emits, as everywhere in
// Octalux.
#ifndef OCTALUX_VIEWER_GBUFFER_PASS_H
#define OCTALUX_VIEWER_GBUFFER_PASS_H

#include "frame_images.h"
#include "raster_view.h"
#include "scene_upload.h"

typedef struct gbuffer_pass {
  VkRenderPass render_pass;
  VkPipelineLayout layout;
  VkPipeline pipeline;
  VkFramebuffer framebuffer; // for the images that are attached
} gbuffer_pass;

// Creates the pass; `set_layout` is any scene's, since all are alike.
bool gbuffer_pass_create(gpu_device *device, VkDescriptorSetLayout set_layout, gbuffer_pass *pass);
void gbuffer_pass_destroy(gpu_device *device, gbuffer_pass *pass);

// Sets the images to draw into from now on; no pending work may draw into the previous ones. The caller calls this
// after each frame_images_create.
bool gbuffer_pass_attach(gpu_device *device, gbuffer_pass *pass, const frame_images *images);

// Records clearing and drawing. Waits for compute and transfers recorded before; later compute may read and write all
// images.
void gbuffer_pass_record(const gpu_device *device, const gbuffer_pass *pass, VkCommandBuffer commands,
                         const frame_images *images, const raster_view *view, const draw_item *items, uint32_t count);

#endif
