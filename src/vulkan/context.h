// The host's device as the runtime uses it: its functions, limits and memory types, and its results as messages.
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

// Creates a context. OLX_ERROR_ARGUMENT for a host that lacks something, OLX_ERROR_UNSUPPORTED for a device that is too
// old.
olx_result olx_vulkan_context_make(const olx_vulkan_host *host, olx_vulkan_context *context);

// Returns OLX_OK or the error of a failed call; `call` is the call's name and `what` is what it was for.
olx_result olx_vulkan_check(VkResult result, const char *call, const char *what);

// Allocates memory of one of the allowed types with all the wanted properties.
olx_result olx_vulkan_allocate(const olx_vulkan_context *context, const VkMemoryRequirements *requirements,
                               VkMemoryPropertyFlags properties, const char *what, VkDeviceMemory *memory);

// The stages of a host's own shaders that may read the library's sets.
enum { OLX_HOST_STAGES = VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT | VK_SHADER_STAGE_COMPUTE_BIT };

// The bindings of a descriptor set: a bit for each binding of each kind, and the stages that use them.
typedef struct olx_set_bindings {
  uint32_t uniforms, buffers, sampled, stored; // uniform and storage buffers, sampled and storage images
  VkShaderStageFlags stages;
} olx_set_bindings;

olx_result olx_vulkan_set_layout_create(const olx_vulkan_context *context, const olx_set_bindings *bindings,
                                        const char *what, VkDescriptorSetLayout *layout);

// A buffer to copy from, in memory visible to host and device.
typedef struct olx_staging {
  VkBuffer buffer;
  VkDeviceMemory memory;
  unsigned char *mapped;
} olx_staging;

// Creates a staging buffer. After a failure olx_staging_destroy must still be called.
olx_result olx_staging_create(const olx_vulkan_context *context, VkDeviceSize bytes, const char *what,
                              olx_staging *staging);
void olx_staging_destroy(const olx_vulkan_context *context, olx_staging *staging);

#endif
