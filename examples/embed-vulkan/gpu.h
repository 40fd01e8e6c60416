// The host's own Vulkan: a device, buffers, images, shaders. Nothing here uses Octalux; an engine already has all of
// it. Errors of Vulkan end the program with a message.
#ifndef GPU_H
#define GPU_H

#include <vulkan/vulkan.h>

#include <stdbool.h>
#include <stddef.h>

typedef struct gpu {
  VkInstance instance;
  VkDebugUtilsMessengerEXT messenger;
  VkPhysicalDevice physical_device;
  VkDevice device;
  VkQueue queue;
  uint32_t queue_family; // graphics and compute
  bool texture_compression_bc; // supported by the device, and enabled
  VkCommandPool pool;
  VkCommandBuffer commands;
  char name[VK_MAX_PHYSICAL_DEVICE_NAME_SIZE];
  bool validated; // the validation layers are active
  uint32_t validation_messages;
} gpu;

typedef struct gpu_buffer {
  VkBuffer buffer;
  VkDeviceMemory memory;
  void *mapped; // host-visible and coherent
} gpu_buffer;

typedef struct gpu_image {
  VkImage image;
  VkDeviceMemory memory;
  VkImageView view;
  VkFormat format;
} gpu_image;

void gpu_need(VkResult result, const char *what);

// Returns false when there is no Vulkan 1.2 device. `g` must not be moved until gpu_close.
bool gpu_open(gpu *g, bool validate);
void gpu_close(gpu *g);

// Makes a buffer, with a copy of `data` unless that is NULL.
gpu_buffer gpu_make_buffer(const gpu *g, size_t bytes, VkBufferUsageFlags usage, const void *data);
void gpu_free_buffer(const gpu *g, gpu_buffer *buffer);

gpu_image gpu_make_image(const gpu *g, VkExtent2D size, VkFormat format, VkImageUsageFlags usage);
void gpu_free_image(const gpu *g, gpu_image *image);

// Begin to record commands; gpu_run submits them and waits.
void gpu_begin(const gpu *g);
void gpu_run(const gpu *g);

// An order of accesses: writes of the stages `from` are finished and visible to the stages `to`.
typedef struct gpu_order {
  VkPipelineStageFlags from;
  VkAccessFlags wrote;
  VkPipelineStageFlags to;
  VkAccessFlags access;
} gpu_order;

void gpu_barrier(const gpu *g, gpu_order order);
// Records such a barrier for one image, which also changes its layout.
void gpu_change_layout(const gpu *g, const gpu_image *image, VkImageLayout old, VkImageLayout new, gpu_order order);

VkShaderModule gpu_make_shader(const gpu *g, const uint32_t *words, size_t bytes);

#endif
