// The viewer's own passes over a lit frame: a picture from the field alone, the pick, overlays, balls and the map.
#ifndef OCTALUX_VIEW_PASSES_H
#define OCTALUX_VIEW_PASSES_H

#include "frame_images.h"
#include "gpu_pipeline.h"
#include "raster_view.h"
#include "view_state.h"

typedef enum view_pipeline {
  VIEW_PIPELINE_PRIMARY = 0,
  VIEW_PIPELINE_PICK,
  VIEW_PIPELINE_OVERLAY,
  VIEW_PIPELINE_BALLS,
  VIEW_PIPELINE_MAP,
  VIEW_PIPELINES
} view_pipeline;

typedef struct view_passes {
  gpu_buffer pick;
  VkSampler sampler;
  gpu_set set;
  VkDescriptorSet field_set;
  VkRenderPass screen;
  VkPipelineLayout layout;
  VkPipeline pipelines[VIEW_PIPELINES]; // each made when it is first wanted
} view_passes;

// `screen` is the render pass in which balls and the map are drawn. The field must outlive the passes.
bool view_passes_create(gpu_device *device, const olx_vulkan_field *field, VkRenderPass screen, view_passes *passes);
void view_passes_destroy(gpu_device *device, view_passes *passes);
// Whether the pipelines that a state wants are there; view_passes_prepare makes those that are not.
bool view_passes_are_ready(const view_passes *passes, const view_state *state);
bool view_passes_prepare(gpu_device *device, view_passes *passes, const view_state *state);
void view_passes_attach(gpu_device *device, view_passes *passes, const frame_images *images);

// What a frame's passes need to know.
typedef struct view_frame {
  const view_state *state;
  const olx_field_info *field;
  const raster_view *view;
  const frame_images *images;
  uint32_t width, height; // of the window
  bool relit;             // a relighter changes lights
} view_frame;

// Into FRAME_COLOR, in place of everything that draws triangles.
void view_passes_record_primary(const gpu_device *device, const view_passes *passes, VkCommandBuffer commands,
                                const view_frame *frame);
// After the tone map: what is painted over FRAME_DISPLAY, and the picked ray.
void view_passes_record_overlay(const gpu_device *device, const view_passes *passes, VkCommandBuffer commands,
                                const view_frame *frame);
// In the screen's render pass.
void view_passes_record_balls(const gpu_device *device, const view_passes *passes, VkCommandBuffer commands,
                              const view_frame *frame);
void view_passes_record_map(const gpu_device *device, const view_passes *passes, VkCommandBuffer commands,
                            const view_frame *frame);

// What the pick found, once the commands have run.
view_pick view_passes_read_pick(const view_passes *passes);

#endif
