// The passes for one set of the host's images.
#ifndef OLX_VULKAN_GPU_FRAME_H
#define OLX_VULKAN_GPU_FRAME_H

#include "vulkan/gpu_field.h"

typedef enum olx_pass { OLX_PASS_IRRADIANCE = 0, OLX_PASS_TRACE, OLX_PASS_COMPOSITE, OLX_PASS_COUNT } olx_pass;

// SPIR-V of a pass, built from shaders/pass.
typedef struct olx_pass_code {
  const char *name;
  const uint32_t *words;
  size_t bytes;
} olx_pass_code;

extern const olx_pass_code olx_irradiance_pass, olx_trace_pass, olx_composite_pass;

struct olx_vulkan_frame {
  olx_vulkan_field *field;
  uint32_t width, height;
  bool normal_unorm;
  VkDescriptorSetLayout set_layout;
  VkPipelineLayout layout;
  VkPipeline pipelines[OLX_PASS_COUNT];
  VkDescriptorPool pool;
  VkDescriptorSet set;
};

olx_result olx_vulkan_record_pass(const olx_vulkan_frame *frame, olx_pass pass, VkCommandBuffer commands,
                                  const olx_vulkan_view *view, const olx_vulkan_settings *settings, uint32_t flags);

#endif
