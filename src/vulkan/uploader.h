// Copying to the device through two slots of host-visible memory: one is filled while the other is on its way.
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
  uint32_t slot; // being filled
  uint32_t used; // bytes of it
  bool recording;
} olx_uploader;

// After a failure olx_uploader_end still has to be called.
olx_result olx_uploader_begin(const olx_vulkan_context *context, olx_uploader *uploader);
// Room for `bytes` (at most a slot) in the staging buffer, and the command buffer that copies from there.
olx_result olx_uploader_reserve(olx_uploader *uploader, uint32_t bytes, void **memory, VkDeviceSize *offset,
                                VkCommandBuffer *commands);
// Copy any number of bytes to a buffer, a slot at a time.
olx_result olx_uploader_copy(olx_uploader *uploader, const void *data, VkDeviceSize bytes, VkBuffer buffer,
                             VkDeviceSize to);
// Submit what is recorded and wait for everything.
olx_result olx_uploader_finish(olx_uploader *uploader);
void olx_uploader_end(olx_uploader *uploader);

#endif
