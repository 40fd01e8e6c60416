// Shadow maps: one layer of a depth array for each view of each lamp. Draw them once for a scene at rest, again when
// something moves.
#ifndef OCTALUX_VIEWER_SHADOW_PASS_H
#define OCTALUX_VIEWER_SHADOW_PASS_H

#include "lamp_samples.h"
#include "scene_upload.h"

typedef struct shadow_pass {
  uint32_t lamp_count, view_count, map_size;
  uint32_t left_out; // lights beyond what a lamp_list can hold
  lamp_view *views;
  gpu_image maps;      // D32_SFLOAT; between passes in VK_IMAGE_LAYOUT_DEPTH_STENCIL_READ_ONLY_OPTIMAL
  gpu_buffer lamps;    // lamp_count lamps
  gpu_buffer matrices; // view_count lamp_views
  VkRenderPass render_pass;
  VkImageView *layers;
  VkFramebuffer *framebuffers;
  VkPipelineLayout layout;
  VkPipeline opaque, masked;
} shadow_pass;

// `set_layout` is any scene's; `content` is the one whose lights shine.
bool shadow_pass_create(gpu_device *device, VkDescriptorSetLayout set_layout, const olx_scene_content *content,
                        const lamp_settings *settings, shadow_pass *pass);
void shadow_pass_destroy(gpu_device *device, shadow_pass *pass);

// Moves the pass's lamps or changes their strength; the list has to have as many lamps and views as before. Nothing
// that uses the pass may be pending, and all maps have to be drawn again.
bool shadow_pass_change(gpu_device *device, const lamp_list *list, shadow_pass *pass);

// Draw all maps. Waits for compute recorded before; compute that follows may read the maps.
void shadow_pass_record(const gpu_device *device, const shadow_pass *pass, VkCommandBuffer commands,
                        const draw_item *items, uint32_t count);

#endif
