// What the denoiser remembers from frame to frame, in images of its own: surfaces, and each lobe's light. Two of each
// take turns.
#ifndef OLX_VULKAN_GPU_HISTORY_H
#define OLX_VULKAN_GPU_HISTORY_H

#include "vulkan/context.h"

#include <stdbool.h>

enum { OLX_HISTORY_GUIDE = 0, OLX_HISTORY_DIFFUSE, OLX_HISTORY_GLOSSY, OLX_HISTORY_KINDS };

typedef struct olx_gpu_history {
  uint32_t lobes;                       // OLX_VULKAN_LOBE_*; without any there are no images
  VkImage images[OLX_HISTORY_KINDS][2]; // of lobes that are not denoised: none
  VkImageView views[OLX_HISTORY_KINDS][2];
  VkDeviceSize offsets[OLX_HISTORY_KINDS][2];
  VkMemoryRequirements requirements; // of all of them
  VkDeviceMemory memory;
} olx_gpu_history;

// Images without memory; then memory and views. After a failure olx_gpu_history_destroy still has to be called.
olx_result olx_gpu_history_begin(const olx_vulkan_context *context, uint32_t width, uint32_t height, uint32_t lobes,
                                 olx_gpu_history *history);
olx_result olx_gpu_history_allocate(const olx_vulkan_context *context, olx_gpu_history *history);
void olx_gpu_history_destroy(const olx_vulkan_context *context, olx_gpu_history *history);

// Whether there are images of a kind.
bool olx_gpu_history_has(const olx_gpu_history *history, uint32_t kind);

// Order everything that compute shaders have done with a kind's images before what they do next. When its history
// begins, the images also get their layout, VK_IMAGE_LAYOUT_GENERAL, and lose what they held.
void olx_gpu_history_barrier(const olx_vulkan_context *context, const olx_gpu_history *history, uint32_t kind,
                             bool begins, VkCommandBuffer commands);

#endif
