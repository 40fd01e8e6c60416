// Creates buffers and images, each with its own memory, copies data to and from them, and records barriers.
#include "gpu_memory.h"

#include <string.h>

static VkResult allocate(gpu_device *d, const VkMemoryRequirements *needed, VkMemoryPropertyFlags flags,
                         VkDeviceMemory *memory) {
  for (uint32_t type = 0; type < d->memory.memoryTypeCount; type++) {
    if (!(needed->memoryTypeBits >> type & 1u) || (d->memory.memoryTypes[type].propertyFlags & flags) != flags)
      continue;
    const VkMemoryAllocateInfo info = {
        .sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, .allocationSize = needed->size, .memoryTypeIndex = type};
    return d->AllocateMemory(d->host.device, &info, NULL, memory);
  }
  return VK_ERROR_OUT_OF_DEVICE_MEMORY;
}

bool gpu_buffer_create(gpu_device *d, const char *what, VkDeviceSize bytes, VkBufferUsageFlags usage, bool host,
                       gpu_buffer *b) {
  *b = (gpu_buffer){.bytes = bytes};
  const VkBufferCreateInfo info = {.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO, .size = bytes, .usage = usage};
  VkResult result = d->CreateBuffer(d->host.device, &info, NULL, &b->buffer);
  if (result == VK_SUCCESS) {
    VkMemoryRequirements needed;
    d->GetBufferMemoryRequirements(d->host.device, b->buffer, &needed);
    const VkMemoryPropertyFlags shared = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    // Memory without a cache is slow to read, so that what the device writes goes to cached memory where there is some.
    result = host && (usage & VK_BUFFER_USAGE_TRANSFER_DST_BIT)
                 ? allocate(d, &needed, shared | VK_MEMORY_PROPERTY_HOST_CACHED_BIT, &b->memory)
                 : VK_ERROR_OUT_OF_DEVICE_MEMORY;
    if (result != VK_SUCCESS)
      result = allocate(d, &needed, host ? shared : VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, &b->memory);
  }
  if (result == VK_SUCCESS) result = d->BindBufferMemory(d->host.device, b->buffer, b->memory, 0);
  if (result == VK_SUCCESS && host) {
    result = d->MapMemory(d->host.device, b->memory, 0, VK_WHOLE_SIZE, 0, &b->mapped);
  }
  if (result == VK_SUCCESS) return true;
  gpu_buffer_destroy(d, b);
  return gpu_fail_result(d, result, what);
}

bool gpu_buffer_refill(gpu_device *d, const char *what, const void *data, gpu_buffer *b) {
  gpu_buffer staging;
  if (!gpu_buffer_create(d, what, b->bytes, VK_BUFFER_USAGE_TRANSFER_SRC_BIT, true, &staging)) return false;
  memcpy(staging.mapped, data, b->bytes);
  bool fine = gpu_commands_begin(d);
  if (fine) {
    const VkBufferCopy region = {.size = b->bytes};
    d->CmdCopyBuffer(d->commands, staging.buffer, b->buffer, 1, &region);
    gpu_memory_barrier(d, d->commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_WRITE_BIT,
                       VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, VK_ACCESS_MEMORY_READ_BIT);
    fine = gpu_commands_run(d);
  }
  gpu_buffer_destroy(d, &staging);
  return fine;
}

bool gpu_buffer_upload(gpu_device *d, const char *what, const void *data, VkDeviceSize bytes, VkBufferUsageFlags usage,
                       gpu_buffer *b) {
  if (gpu_buffer_create(d, what, bytes, usage | VK_BUFFER_USAGE_TRANSFER_DST_BIT, false, b) &&
      gpu_buffer_refill(d, what, data, b))
    return true;
  gpu_buffer_destroy(d, b);
  return false;
}

void gpu_buffer_destroy(gpu_device *d, gpu_buffer *b) {
  if (b->buffer) d->DestroyBuffer(d->host.device, b->buffer, NULL);
  if (b->memory) d->FreeMemory(d->host.device, b->memory, NULL);
  *b = (gpu_buffer){.bytes = 0};
}

static VkResult create_view(gpu_device *d, bool array, gpu_image *image) {
  const VkImageViewCreateInfo view = {
      .sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
      .image = image->image,
      .viewType = array ? VK_IMAGE_VIEW_TYPE_2D_ARRAY : VK_IMAGE_VIEW_TYPE_2D,
      .format = image->format,
      .subresourceRange = {image->aspect, 0, image->levels, 0, image->layers},
  };
  return d->CreateImageView(d->host.device, &view, NULL, &image->view);
}

bool gpu_image_create(gpu_device *d, const gpu_image_info *info, gpu_image *image) {
  const bool depth = info->format == VK_FORMAT_D32_SFLOAT || info->format == VK_FORMAT_D16_UNORM;
  *image = (gpu_image){.format = info->format,
                       .aspect = depth ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT,
                       .width = info->width,
                       .height = info->height,
                       .layers = info->layers ? info->layers : 1,
                       .levels = info->levels ? info->levels : 1};
  const VkPhysicalDeviceLimits *most = &d->properties.limits;
  if (info->width > most->maxImageDimension2D || info->height > most->maxImageDimension2D ||
      image->layers > most->maxImageArrayLayers) {
    return gpu_fail(d, "%s: the device has no images of %u x %u pixels and %u layers", info->what, info->width,
                    info->height, image->layers);
  }
  const VkImageCreateInfo create = {.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
                                    .imageType = VK_IMAGE_TYPE_2D,
                                    .format = info->format,
                                    .extent = {info->width, info->height, 1},
                                    .mipLevels = image->levels,
                                    .arrayLayers = image->layers,
                                    .samples = VK_SAMPLE_COUNT_1_BIT,
                                    .usage = info->usage};
  VkResult result = d->CreateImage(d->host.device, &create, NULL, &image->image);
  if (result == VK_SUCCESS) {
    VkMemoryRequirements needed;
    d->GetImageMemoryRequirements(d->host.device, image->image, &needed);
    result = allocate(d, &needed, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, &image->memory);
  }
  if (result == VK_SUCCESS) result = d->BindImageMemory(d->host.device, image->image, image->memory, 0);
  if (result == VK_SUCCESS) result = create_view(d, info->layers != 0, image);
  if (result == VK_SUCCESS) return true;
  gpu_image_destroy(d, image);
  return gpu_fail_result(d, result, info->what);
}

void gpu_image_destroy(gpu_device *d, gpu_image *image) {
  if (image->view) d->DestroyImageView(d->host.device, image->view, NULL);
  if (image->image) d->DestroyImage(d->host.device, image->image, NULL);
  if (image->memory) d->FreeMemory(d->host.device, image->memory, NULL);
  *image = (gpu_image){.width = 0};
}

static void levels_barrier(const gpu_device *d, VkCommandBuffer commands, const gpu_image *image, uint32_t first,
                           uint32_t count, VkImageLayout from, VkImageLayout to) {
  const VkImageMemoryBarrier barrier = {.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER,
                                        .srcAccessMask = VK_ACCESS_MEMORY_WRITE_BIT,
                                        .dstAccessMask = VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT,
                                        .oldLayout = from,
                                        .newLayout = to,
                                        .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                                        .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                                        .image = image->image,
                                        .subresourceRange = {image->aspect, first, count, 0, image->layers}};
  d->CmdPipelineBarrier(commands, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, 0, 0, NULL, 0,
                        NULL, 1, &barrier);
}

void gpu_image_barrier(const gpu_device *d, VkCommandBuffer commands, const gpu_image *image, VkImageLayout from,
                       VkImageLayout to) {
  levels_barrier(d, commands, image, 0, image->levels, from, to);
}

void gpu_level_barrier(const gpu_device *d, VkCommandBuffer commands, const gpu_image *image, uint32_t level,
                       VkImageLayout from, VkImageLayout to) {
  levels_barrier(d, commands, image, level, 1, from, to);
}

void gpu_full_barrier(const gpu_device *d, VkCommandBuffer commands) {
  gpu_memory_barrier(d, commands, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, VK_ACCESS_MEMORY_WRITE_BIT,
                     VK_PIPELINE_STAGE_ALL_COMMANDS_BIT | VK_PIPELINE_STAGE_HOST_BIT,
                     VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT);
}

void gpu_memory_barrier(const gpu_device *d, VkCommandBuffer commands, VkPipelineStageFlags from_stage,
                        VkAccessFlags from_access, VkPipelineStageFlags to_stage, VkAccessFlags to_access) {
  const VkMemoryBarrier barrier = {
      .sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER, .srcAccessMask = from_access, .dstAccessMask = to_access};
  d->CmdPipelineBarrier(commands, from_stage, to_stage, 0, 1, &barrier, 0, NULL, 0, NULL);
}

static VkBufferImageCopy whole_image(const gpu_image *image) {
  return (VkBufferImageCopy){.imageSubresource = {image->aspect, 0, 0, 1},
                             .imageExtent = {image->width, image->height, 1}};
}

bool gpu_image_write(gpu_device *d, const gpu_image *image, VkImageLayout layout, const gpu_buffer *buffer) {
  if (!gpu_commands_begin(d)) return false;
  const VkBufferImageCopy region = whole_image(image);
  const VkImageLayout target = VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL;
  gpu_image_barrier(d, d->commands, image, VK_IMAGE_LAYOUT_UNDEFINED, target);
  d->CmdCopyBufferToImage(d->commands, buffer->buffer, image->image, target, 1, &region);
  gpu_image_barrier(d, d->commands, image, target, layout);
  return gpu_commands_run(d);
}

bool gpu_image_read(gpu_device *d, const gpu_image *image, VkImageLayout layout, const gpu_buffer *buffer) {
  if (!gpu_commands_begin(d)) return false;
  const VkBufferImageCopy region = whole_image(image);
  const VkImageLayout source = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL;
  gpu_image_barrier(d, d->commands, image, layout, source);
  d->CmdCopyImageToBuffer(d->commands, image->image, source, buffer->buffer, 1, &region);
  gpu_image_barrier(d, d->commands, image, source, layout);
  gpu_memory_barrier(d, d->commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_WRITE_BIT,
                     VK_PIPELINE_STAGE_HOST_BIT, VK_ACCESS_HOST_READ_BIT);
  return gpu_commands_run(d);
}
