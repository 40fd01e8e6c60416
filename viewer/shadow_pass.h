// Shadow maps: one layer of a depth array for each view of each lamp. To be drawn once for a static scene, and again
// when something moves.
#ifndef OCTALUX_VIEWER_SHADOW_PASS_H
#define OCTALUX_VIEWER_SHADOW_PASS_H

#include "lamp_samples.h"
#include "scene_upload.h"

typedef struct shadow_pass {
  uint32_t lamp_count, view_count, map_size;
  uint32_t left_out; // lights that exceed the capacity of a lamp_list
  lamp_view *views;
  gpu_image maps;      // D32_SFLOAT; between passes in VK_IMAGE_LAYOUT_DEPTH_STENCIL_READ_ONLY_OPTIMAL
  gpu_buffer lamps;    // an array of lamp_count lamps
  gpu_buffer matrices; // an array of view_count lamp_views
  VkRenderPass render_pass;
  VkImageView *layers;
  VkFramebuffer *framebuffers;
  VkPipelineLayout layout;
  VkPipeline opaque, masked;
} shadow_pass;

// Creates the pass. `set_layout` is any scene's; `content` is the scene whose lights cast shadows.
bool shadow_pass_create(gpu_device *device, VkDescriptorSetLayout set_layout, const olx_scene_content *content,
                        const lamp_settings *settings, shadow_pass *pass);
void shadow_pass_destroy(gpu_device *device, shadow_pass *pass);

// Moves the pass's lamps or changes their strength; the list must have as many lamps and views as before. No pending
// work may use the pass, and all maps must be drawn again.
bool shadow_pass_change(gpu_device *device, const lamp_list *list, shadow_pass *pass);

// Draws all maps. Waits for compute recorded before; later compute may read the maps.
void shadow_pass_record(const gpu_device *device, const shadow_pass *pass, VkCommandBuffer commands,
                        const draw_item *items, uint32_t count);

#endif
