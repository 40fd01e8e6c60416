// Copies data to the device through two slots of host-visible memory: one is filled while the other is being copied.
#ifndef OLX_VULKAN_UPLOADER_H
#define OLX_VULKAN_UPLOADER_H

#include "vulkan/context.h"

enum { OLX_STAGING_SLOTS = 2, OLX_STAGING_SLOT_BYTES = 8 << 20 };

typedef struct olx_uploader {
  const olx_vulkan_context *context;
  olx_staging staging;
  VkCommandPool pool;
  VkCommandBuffer commands[OLX_STAGING_SLOTS];
  VkFence fences[OLX_STAGING_SLOTS];
  bool pending[OLX_STAGING_SLOTS];
  uint32_t slot; // the slot being filled
  uint32_t used; // bytes of it in use
  bool recording;
} olx_uploader;

// Begins an upload. After a failure olx_uploader_end must still be called.
olx_result olx_uploader_begin(const olx_vulkan_context *context, olx_uploader *uploader);
// Reserves `bytes` (at most a slot) in the staging buffer, and returns the command buffer for copies from there.
olx_result olx_uploader_reserve(olx_uploader *uploader, uint32_t bytes, void **memory, VkDeviceSize *offset,
                                VkCommandBuffer *commands);
// Copies any number of bytes to a buffer, a slot at a time.
olx_result olx_uploader_copy(olx_uploader *uploader, const void *data, VkDeviceSize bytes, VkBuffer buffer,
                             VkDeviceSize to);
// Submits what is recorded and waits until it is complete.
olx_result olx_uploader_finish(olx_uploader *uploader);
void olx_uploader_end(olx_uploader *uploader);

#endif
