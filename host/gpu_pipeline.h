// Descriptor sets, and pipelines from embedded SPIR-V.
#ifndef OCTALUX_HOST_GPU_PIPELINE_H
#define OCTALUX_HOST_GPU_PIPELINE_H

#include "gpu_memory.h"

// A binding of a set; its number is its index.
typedef struct gpu_binding {
  VkDescriptorType type;
  const gpu_buffer *buffer; // for buffers
  VkImageView view;         // for images
  VkSampler sampler;
  VkImageLayout layout;
} gpu_binding;

enum { GPU_MAX_BINDINGS = 16 };

typedef struct gpu_set {
  VkDescriptorSetLayout layout;
  VkDescriptorPool pool;
  VkDescriptorSet set;
} gpu_set;

// Creates a descriptor set with bindings of these types; gpu_set_write fills it.
bool gpu_set_create(gpu_device *device, const char *what, const VkDescriptorType *types, uint32_t count,
                    VkShaderStageFlags stages, gpu_set *set);
void gpu_set_write(const gpu_device *device, const gpu_set *set, const gpu_binding *bindings, uint32_t count);
void gpu_set_destroy(gpu_device *device, gpu_set *set);

// SPIR-V of one shader, whose entry point is main.
typedef struct gpu_code {
  const uint32_t *words; // NULL: no shader
  size_t bytes;
} gpu_code;

#define GPU_CODE(array) ((gpu_code){array, sizeof(array)})

// Creates a layout of descriptor sets from 0 on, and of push constants that these stages read.
bool gpu_layout_create(gpu_device *device, const char *what, const VkDescriptorSetLayout *sets, uint32_t set_count,
                       VkShaderStageFlags stages, uint32_t push_bytes, VkPipelineLayout *layout);

enum { GPU_MOST_COLORS = 5 }; // most color attachments of a graphics pipeline

typedef struct gpu_graphics_info {
  const char *what;
  VkPipelineLayout layout;
  VkRenderPass render_pass;
  gpu_code vertex, fragment; // the fragment shader may be absent
  bool strip;                // triangle strips instead of lists
  bool blended;              // alpha blending, with one attachment
  uint32_t colors;           // number of color attachments, at most GPU_MOST_COLORS
  VkCompareOp depth;         // depth test
  float slope_bias;          // slope-scaled depth bias; 0: none
} gpu_graphics_info;

// Creates a graphics pipeline without vertex input: two-sided triangles, depth tested and written, dynamic viewport and
// scissor.
bool gpu_graphics_create(gpu_device *device, const gpu_graphics_info *info, VkPipeline *pipeline);
// Sets viewport and scissor to the whole image.
void gpu_viewport_record(const gpu_device *device, VkCommandBuffer commands, uint32_t width, uint32_t height);

bool gpu_compute_pipeline_create(gpu_device *device, const char *what, gpu_code code, VkPipelineLayout layout,
                                 VkPipeline *pipeline);

// A compute pipeline with its own layout.
typedef struct gpu_compute {
  VkPipelineLayout layout;
  VkPipeline pipeline;
} gpu_compute;

bool gpu_compute_create(gpu_device *device, const char *what, gpu_code code, const VkDescriptorSetLayout *sets,
                        uint32_t set_count, uint32_t push_bytes, gpu_compute *compute);
void gpu_compute_destroy(gpu_device *device, gpu_compute *compute);
// Binds the pipeline with sets and constants, and dispatches groups of 8 x 8 pixels.
void gpu_compute_record(const gpu_device *device, const gpu_compute *compute, const VkDescriptorSet *sets,
                        uint32_t set_count, const void *push, uint32_t push_bytes, uint32_t width, uint32_t height,
                        VkCommandBuffer commands);

#endif
