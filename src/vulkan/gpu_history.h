// The denoiser's history from frame to frame, in images of its own: surfaces, and each lobe's light. There are two
// images of each kind, which alternate.
#ifndef OLX_VULKAN_GPU_HISTORY_H
#define OLX_VULKAN_GPU_HISTORY_H

#include "vulkan/context.h"

#include <stdbool.h>

enum { OLX_HISTORY_GUIDE = 0, OLX_HISTORY_DIFFUSE, OLX_HISTORY_GLOSSY, OLX_HISTORY_KINDS };

typedef struct olx_gpu_history {
  uint32_t lobes;                       // OLX_VULKAN_LOBE_*; 0: no images
  VkImage images[OLX_HISTORY_KINDS][2]; // none for lobes that are not denoised
  VkImageView views[OLX_HISTORY_KINDS][2];
  VkDeviceSize offsets[OLX_HISTORY_KINDS][2];
  VkMemoryRequirements requirements; // of all images together
  VkDeviceMemory memory;
} olx_gpu_history;

// Creates images without memory; olx_gpu_history_allocate adds memory and views. After a failure
// olx_gpu_history_destroy must still be called.
olx_result olx_gpu_history_begin(const olx_vulkan_context *context, uint32_t width, uint32_t height, uint32_t lobes,
                                 olx_gpu_history *history);
olx_result olx_gpu_history_allocate(const olx_vulkan_context *context, olx_gpu_history *history);
void olx_gpu_history_destroy(const olx_vulkan_context *context, olx_gpu_history *history);

// Returns whether there are images of a kind.
bool olx_gpu_history_has(const olx_gpu_history *history, uint32_t kind);

// Orders all earlier accesses of compute shaders to a kind's images before the later ones. At the start of a history,
// the images also change to VK_IMAGE_LAYOUT_GENERAL and lose their contents.
void olx_gpu_history_barrier(const olx_vulkan_context *context, const olx_gpu_history *history, uint32_t kind,
                             bool begins, VkCommandBuffer commands);

#endif
