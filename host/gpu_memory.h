// Buffers, images and barriers. Every buffer and image has memory of its own.
#ifndef OCTALUX_HOST_GPU_MEMORY_H
#define OCTALUX_HOST_GPU_MEMORY_H

#include "gpu_device.h"

typedef struct gpu_buffer {
  VkBuffer buffer;
  VkDeviceMemory memory;
  void *mapped; // NULL when it is the device's alone
  VkDeviceSize bytes;
} gpu_buffer;

// `what` names it in messages. With `host` both sides see it, coherently, else it lies in device-local memory.
bool gpu_buffer_create(gpu_device *device, const char *what, VkDeviceSize bytes, VkBufferUsageFlags usage, bool host,
                       gpu_buffer *buffer);
// Creates a buffer in device-local memory that holds `data`.
bool gpu_buffer_upload(gpu_device *device, const char *what, const void *data, VkDeviceSize bytes,
                       VkBufferUsageFlags usage, gpu_buffer *buffer);
// Replaces all data of a buffer that gpu_buffer_upload made; nothing that uses it may be pending.
bool gpu_buffer_refill(gpu_device *device, const char *what, const void *data, gpu_buffer *buffer);
void gpu_buffer_destroy(gpu_device *device, gpu_buffer *buffer);

typedef struct gpu_image {
  VkImage image;
  VkImageView view; // all layers and levels
  VkDeviceMemory memory;
  VkFormat format;
  VkImageAspectFlags aspect; // depth for depth formats, else color
  uint32_t width, height, layers, levels;
} gpu_image;

typedef struct gpu_image_info {
  const char *what;
  VkFormat format;
  uint32_t width, height;
  uint32_t layers; // 0: a plain 2D image; else a 2D array
  uint32_t levels; // 0: 1
  VkImageUsageFlags usage;
} gpu_image_info;

bool gpu_image_create(gpu_device *device, const gpu_image_info *info, gpu_image *image);
void gpu_image_destroy(gpu_device *device, gpu_image *image);

// A barrier between all that was recorded before and all that follows, and a change of layout of the whole image.
void gpu_image_barrier(const gpu_device *device, VkCommandBuffer commands, const gpu_image *image, VkImageLayout from,
                       VkImageLayout to);
// Records a barrier and a change of layout for one level of an image.
void gpu_level_barrier(const gpu_device *device, VkCommandBuffer commands, const gpu_image *image, uint32_t level,
                       VkImageLayout from, VkImageLayout to);
// A barrier for all memory between all that was recorded before and all that follows, the host's reading too.
void gpu_full_barrier(const gpu_device *device, VkCommandBuffer commands);
// A barrier for memory from one kind of use to another.
void gpu_memory_barrier(const gpu_device *device, VkCommandBuffer commands, VkPipelineStageFlags from_stage,
                        VkAccessFlags from_access, VkPipelineStageFlags to_stage, VkAccessFlags to_access);

// Copy `buffer`, tightly packed, into a plain color image (level 0), whatever it held; leave it in `layout`, and wait.
bool gpu_image_write(gpu_device *device, const gpu_image *image, VkImageLayout layout, const gpu_buffer *buffer);
// Copy a plain color image (level 0), which is in `layout` and stays in it, into `buffer`, tightly packed, and wait.
bool gpu_image_read(gpu_device *device, const gpu_image *image, VkImageLayout layout, const gpu_buffer *buffer);

#endif
