// The window's images: a finished image is copied into one and presented.
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
  bool stale; // the window has changed: recreate the swapchain
} view_swapchain;

// Creates or recreates the swapchain for the current surface. Where the window has no pixels, the swapchain is empty,
// which is not a failure.
bool view_swapchain_create(gpu_device *device, uint32_t width, uint32_t height, bool wait_for_display,
                           view_swapchain *chain);
void view_swapchain_destroy(gpu_device *device, view_swapchain *chain);

// Waits for an image. Returns true with *index UINT32_MAX when there is none because the swapchain is stale.
bool view_swapchain_acquire(gpu_device *device, view_swapchain *chain, uint32_t *index);

// Records scaling the source, in VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, into that image, which can then be presented.
void view_swapchain_record(const gpu_device *device, const view_swapchain *chain, uint32_t index,
                           VkCommandBuffer commands, const gpu_image *picture);

// Presents an image, once the commands have run. An acquired image must be presented, however late.
bool view_swapchain_show(gpu_device *device, view_swapchain *chain, uint32_t index);

#endif
