// The window's images: a finished picture is copied into one and shown.
#ifndef OCTALUX_VIEW_SWAPCHAIN_H
#define OCTALUX_VIEW_SWAPCHAIN_H

#include "gpu_memory.h"

enum { VIEW_SWAPCHAIN_IMAGES = 16 };

typedef struct view_swapchain {
  VkSwapchainKHR swapchain;
  VkSurfaceFormatKHR format;
  uint32_t width, height;
  uint32_t image_count;
  VkImage images[VIEW_SWAPCHAIN_IMAGES];
  VkFence acquired;
  bool stale; // the window has changed: make it anew
} view_swapchain;

// Make it for the surface as it is now, or anew. Where the window has no pixels it is empty, which is no failure.
bool view_swapchain_create(gpu_device *device, uint32_t width, uint32_t height, bool wait_for_display,
                           view_swapchain *chain);
void view_swapchain_destroy(gpu_device *device, view_swapchain *chain);

// Wait for an image to draw into. True with *index UINT32_MAX: there is none now, as the swapchain is stale.
bool view_swapchain_acquire(gpu_device *device, view_swapchain *chain, uint32_t *index);

// Record: scale the picture, which lies in VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, into that image; then it can be shown.
void view_swapchain_record(const gpu_device *device, const view_swapchain *chain, uint32_t index,
                           VkCommandBuffer commands, const gpu_image *picture);

// Once the commands have run. An image that was acquired must be shown, however late.
bool view_swapchain_show(gpu_device *device, view_swapchain *chain, uint32_t index);

#endif
