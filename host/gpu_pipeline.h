// Descriptor sets, and pipelines from embedded SPIR-V.
#ifndef OCTALUX_HOST_GPU_PIPELINE_H
#define OCTALUX_HOST_GPU_PIPELINE_H

#include "gpu_memory.h"

// What is bound at one place of a set; the place is its index.
typedef struct gpu_binding {
  VkDescriptorType type;
  const gpu_buffer *buffer; // of buffers
  VkImageView view;         // of images
  VkSampler sampler;
  VkImageLayout layout;
} gpu_binding;

enum { GPU_MAX_BINDINGS = 16 };

typedef struct gpu_set {
  VkDescriptorSetLayout layout;
  VkDescriptorPool pool;
  VkDescriptorSet set;
} gpu_set;

// The types say what the set will hold; gpu_set_write fills it.
bool gpu_set_create(gpu_device *device, const char *what, const VkDescriptorType *types, uint32_t count,
                    VkShaderStageFlags stages, gpu_set *set);
void gpu_set_write(const gpu_device *device, const gpu_set *set, const gpu_binding *bindings, uint32_t count);
void gpu_set_destroy(gpu_device *device, gpu_set *set);

// SPIR-V of one shader, whose entry is main.
typedef struct gpu_code {
  const uint32_t *words; // NULL: no shader
  size_t bytes;
} gpu_code;

#define GPU_CODE(array) ((gpu_code){array, sizeof(array)})

// Descriptor sets from 0 on, and push constants that those stages read.
bool gpu_layout_create(gpu_device *device, const char *what, const VkDescriptorSetLayout *sets, uint32_t set_count,
                       VkShaderStageFlags stages, uint32_t push_bytes, VkPipelineLayout *layout);

enum { GPU_MOST_COLORS = 5 }; // attachments of a graphics pipeline

typedef struct gpu_graphics_info {
  const char *what;
  VkPipelineLayout layout;
  VkRenderPass render_pass;
  gpu_code vertex, fragment; // there may be no fragment shader
  bool strip;                // of triangles, in place of separate ones
  bool blended;              // by alpha over what is there, of one attachment
  uint32_t colors;           // attachments, at most GPU_MOST_COLORS
  VkCompareOp depth;         // of what is drawn with what is there
  float slope_bias;          // of depth; 0: none
} gpu_graphics_info;

// Without vertex input. Triangles from both sides, depth tested and written, viewport and scissor dynamic.
bool gpu_graphics_create(gpu_device *device, const gpu_graphics_info *info, VkPipeline *pipeline);
// The whole of a picture.
void gpu_viewport_record(const gpu_device *device, VkCommandBuffer commands, uint32_t width, uint32_t height);

bool gpu_compute_pipeline_create(gpu_device *device, const char *what, gpu_code code, VkPipelineLayout layout,
                                 VkPipeline *pipeline);

// A pipeline with a layout of its own.
typedef struct gpu_compute {
  VkPipelineLayout layout;
  VkPipeline pipeline;
} gpu_compute;

bool gpu_compute_create(gpu_device *device, const char *what, gpu_code code, const VkDescriptorSetLayout *sets,
                        uint32_t set_count, uint32_t push_bytes, gpu_compute *compute);
void gpu_compute_destroy(gpu_device *device, gpu_compute *compute);
// Bind it with sets and constants, and run it on groups of 8 x 8 pixels.
void gpu_compute_record(const gpu_device *device, const gpu_compute *compute, const VkDescriptorSet *sets,
                        uint32_t set_count, const void *push, uint32_t push_bytes, uint32_t width, uint32_t height,
                        VkCommandBuffer commands);

#endif
