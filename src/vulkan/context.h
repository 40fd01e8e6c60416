// The host's device as the runtime sees it: its functions, limits and memory types; and results as messages.
#ifndef OLX_VULKAN_CONTEXT_H
#define OLX_VULKAN_CONTEXT_H

#include "core/result.h"
#include "vulkan/vulkan_functions.h"

typedef struct olx_vulkan_context {
  olx_vulkan_host host;
  olx_vulkan_functions vk;
  VkPhysicalDeviceLimits limits;
  VkPhysicalDeviceMemoryProperties memory;
} olx_vulkan_context;

// OLX_ERROR_ARGUMENT for a host that lacks something, OLX_ERROR_UNSUPPORTED for a device that is too old.
olx_result olx_vulkan_context_make(const olx_vulkan_host *host, olx_vulkan_context *context);

// OLX_OK, or what a failed call means; `call` is its name and `what` the thing it was for.
olx_result olx_vulkan_check(VkResult result, const char *call, const char *what);

// Memory of one of the allowed types with all the wanted properties.
olx_result olx_vulkan_allocate(const olx_vulkan_context *context, const VkMemoryRequirements *requirements,
                               VkMemoryPropertyFlags properties, const char *what, VkDeviceMemory *memory);

// A buffer to copy from, in memory that host and device see.
typedef struct olx_staging {
  VkBuffer buffer;
  VkDeviceMemory memory;
  unsigned char *mapped;
} olx_staging;

// After a failure olx_staging_destroy still has to be called.
olx_result olx_staging_create(const olx_vulkan_context *context, VkDeviceSize bytes, const char *what,
                              olx_staging *staging);
void olx_staging_destroy(const olx_vulkan_context *context, olx_staging *staging);

#endif
