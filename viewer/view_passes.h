// The viewer's own passes over a lit frame: an image from the field alone, the pick, overlays, balls and the map.
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
  VkPipeline pipelines[VIEW_PIPELINES]; // each created on first use
} view_passes;

// Creates the passes. `screen` is the render pass in which balls and the map are drawn. The field must outlive the
// passes.
bool view_passes_create(gpu_device *device, const olx_vulkan_field *field, VkRenderPass screen, view_passes *passes);
void view_passes_destroy(gpu_device *device, view_passes *passes);
// Returns whether the pipelines for a state exist; view_passes_prepare creates missing ones.
bool view_passes_are_ready(const view_passes *passes, const view_state *state);
bool view_passes_prepare(gpu_device *device, view_passes *passes, const view_state *state);
void view_passes_attach(gpu_device *device, view_passes *passes, const frame_images *images);

// The inputs of a frame's passes.
typedef struct view_frame {
  const view_state *state;
  const olx_field_info *field;
  const raster_view *view;
  const frame_images *images;
  uint32_t width, height; // size of the window
  bool relit;             // a relighter changes lights
} view_frame;

// Renders the field into FRAME_COLOR, in place of all passes that draw triangles.
void view_passes_record_primary(const gpu_device *device, const view_passes *passes, VkCommandBuffer commands,
                                const view_frame *frame);
// Draws overlays into FRAME_DISPLAY after the tone map, and traces the picked ray.
void view_passes_record_overlay(const gpu_device *device, const view_passes *passes, VkCommandBuffer commands,
                                const view_frame *frame);
// Draws balls in the screen's render pass.
void view_passes_record_balls(const gpu_device *device, const view_passes *passes, VkCommandBuffer commands,
                              const view_frame *frame);
void view_passes_record_map(const gpu_device *device, const view_passes *passes, VkCommandBuffer commands,
                            const view_frame *frame);

// Reads the result of the pick, once the commands have run.
view_pick view_passes_read_pick(const view_passes *passes);

#endif
