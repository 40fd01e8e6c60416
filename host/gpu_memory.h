// Buffers, images and barriers. Every buffer and every image has its own memory.
#ifndef OCTALUX_HOST_GPU_MEMORY_H
#define OCTALUX_HOST_GPU_MEMORY_H

#include "gpu_device.h"

typedef struct gpu_buffer {
  VkBuffer buffer;
  VkDeviceMemory memory;
  void *mapped; // NULL for device-local memory
  VkDeviceSize bytes;
} gpu_buffer;

// Creates a buffer; `what` names it in messages. With `host` its memory is mapped and coherent, otherwise device-local.
bool gpu_buffer_create(gpu_device *device, const char *what, VkDeviceSize bytes, VkBufferUsageFlags usage, bool host,
                       gpu_buffer *buffer);
// Creates a buffer in device-local memory that holds `data`.
bool gpu_buffer_upload(gpu_device *device, const char *what, const void *data, VkDeviceSize bytes,
                       VkBufferUsageFlags usage, gpu_buffer *buffer);
// Replaces all data of a buffer created by gpu_buffer_upload; no pending work may use it.
bool gpu_buffer_refill(gpu_device *device, const char *what, const void *data, gpu_buffer *buffer);
void gpu_buffer_destroy(gpu_device *device, gpu_buffer *buffer);

typedef struct gpu_image {
  VkImage image;
  VkImageView view; // all layers and levels
  VkDeviceMemory memory;
  VkFormat format;
  VkImageAspectFlags aspect; // depth for depth formats, otherwise color
  uint32_t width, height, layers, levels;
} gpu_image;

typedef struct gpu_image_info {
  const char *what;
  VkFormat format;
  uint32_t width, height;
  uint32_t layers; // 0: a plain 2D image; otherwise a 2D array
  uint32_t levels; // 0 means 1
  VkImageUsageFlags usage;
} gpu_image_info;

bool gpu_image_create(gpu_device *device, const gpu_image_info *info, gpu_image *image);
void gpu_image_destroy(gpu_device *device, gpu_image *image);

// Records a barrier between all earlier and all later commands, and a layout transition of the whole image.
void gpu_image_barrier(const gpu_device *device, VkCommandBuffer commands, const gpu_image *image, VkImageLayout from,
                       VkImageLayout to);
// Records a barrier and a change of layout for one level of an image.
void gpu_level_barrier(const gpu_device *device, VkCommandBuffer commands, const gpu_image *image, uint32_t level,
                       VkImageLayout from, VkImageLayout to);
// Records a barrier for all memory between all earlier and all later commands, including reads by the host.
void gpu_full_barrier(const gpu_device *device, VkCommandBuffer commands);
// Records a memory barrier from one kind of use to another.
void gpu_memory_barrier(const gpu_device *device, VkCommandBuffer commands, VkPipelineStageFlags from_stage,
                        VkAccessFlags from_access, VkPipelineStageFlags to_stage, VkAccessFlags to_access);

// Copies `buffer`, tightly packed, into level 0 of a plain color image, discards its previous content, leaves it in
// `layout`, and waits.
bool gpu_image_write(gpu_device *device, const gpu_image *image, VkImageLayout layout, const gpu_buffer *buffer);
// Copies level 0 of a plain color image, which is and stays in `layout`, into `buffer`, tightly packed, and waits.
bool gpu_image_read(gpu_device *device, const gpu_image *image, VkImageLayout layout, const gpu_buffer *buffer);

#endif
