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

bool gpu_shader_create(gpu_device *device, const char *what, const uint32_t *words, size_t bytes,
                       VkShaderModule *module);

typedef struct gpu_compute {
  VkPipelineLayout layout;
  VkPipeline pipeline;
} gpu_compute;

// Descriptor sets from 0 on, and push constants.
bool gpu_compute_create(gpu_device *device, const char *what, const uint32_t *words, size_t bytes,
                        const VkDescriptorSetLayout *sets, uint32_t set_count, uint32_t push_bytes,
                        gpu_compute *compute);
void gpu_compute_destroy(gpu_device *device, gpu_compute *compute);
// Bind it with sets and constants, and run it on groups of 8 x 8 pixels.
void gpu_compute_record(const gpu_device *device, const gpu_compute *compute, const VkDescriptorSet *sets,
                        uint32_t set_count, const void *push, uint32_t push_bytes, uint32_t width, uint32_t height,
                        VkCommandBuffer commands);

#endif
