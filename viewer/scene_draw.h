// Records the drawing of scenes for several passes, whose pipelines pull vertices from the scene's buffers.
#ifndef OCTALUX_VIEWER_SCENE_DRAW_H
#define OCTALUX_VIEWER_SCENE_DRAW_H

#include "scene_upload.h"

// Push constants, with the layout of shaders/raster_shared.glsl.
typedef struct draw_constants {
  float world_to_clip[16];
  float to_world[12];
  float eye[3];
  uint32_t material;
} draw_constants;

bool scene_draw_layout(gpu_device *device, VkDescriptorSetLayout set_layout, VkPipelineLayout *layout);

enum { DRAW_OPAQUE = 1, DRAW_MASKED = 2 };
// Draws the batches of those kinds that a view may show; to be called within a render pass, with the pipeline bound.
void scene_draw_record(const gpu_device *device, VkCommandBuffer commands, VkPipelineLayout layout,
                       const float world_to_clip[16], olx_vec3 eye, const draw_item *items, uint32_t count,
                       uint32_t kinds);

#endif
