// Maintains the window's swapchain, which becomes stale when the window changes, and presents images.
#include "view_swapchain.h"

static uint32_t between(uint32_t x, uint32_t least, uint32_t most) { return x < least ? least : x > most ? most : x; }

// Images are already sRGB-encoded, so that the format must not encode them again.
static bool choose_format(gpu_device *d, VkSurfaceFormatKHR *chosen) {
  VkSurfaceFormatKHR formats[64];
  uint32_t count = 64;
  const VkResult result = d->GetPhysicalDeviceSurfaceFormatsKHR(d->host.physical_device, d->surface, &count, formats);
  if (result != VK_INCOMPLETE && !gpu_check(d, result, "the window's formats")) return false;
  for (uint32_t i = 0; i < count; i++) {
    const VkFormat format = formats[i].format;
    if (format != VK_FORMAT_B8G8R8A8_UNORM && format != VK_FORMAT_R8G8B8A8_UNORM) continue;
    VkFormatProperties properties;
    d->GetPhysicalDeviceFormatProperties(d->host.physical_device, format, &properties);
    if (!(properties.optimalTilingFeatures & VK_FORMAT_FEATURE_BLIT_DST_BIT)) continue;
    *chosen = formats[i];
    return true;
  }
  return gpu_fail(d, "the window takes no picture of 8-bit RGBA");
}

// The mode that waits for the display is always available; those that do not wait may tear.
static VkPresentModeKHR choose_mode(gpu_device *d, bool wait_for_display) {
  VkPresentModeKHR modes[16], chosen = VK_PRESENT_MODE_FIFO_KHR;
  uint32_t count = 16;
  if (wait_for_display) return chosen;
  if (d->GetPhysicalDeviceSurfacePresentModesKHR(d->host.physical_device, d->surface, &count, modes) < 0) return chosen;
  for (uint32_t i = 0; i < count; i++) {
    if (modes[i] == VK_PRESENT_MODE_MAILBOX_KHR) chosen = modes[i];
    if (modes[i] == VK_PRESENT_MODE_IMMEDIATE_KHR && chosen == VK_PRESENT_MODE_FIFO_KHR) chosen = modes[i];
  }
  return chosen;
}

static bool make(gpu_device *d, const VkSurfaceCapabilitiesKHR *can, bool wait_for_display, view_swapchain *chain,
                 VkSwapchainKHR old) {
  uint32_t count = can->minImageCount + 1;
  if (can->maxImageCount && count > can->maxImageCount) count = can->maxImageCount;
  if (!(can->supportedUsageFlags & VK_IMAGE_USAGE_TRANSFER_DST_BIT)) return gpu_fail(d, "the window takes no copies");
  VkCompositeAlphaFlagBitsKHR alpha = VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR;
  if (!(can->supportedCompositeAlpha & alpha)) alpha = VK_COMPOSITE_ALPHA_INHERIT_BIT_KHR;
  const VkSwapchainCreateInfoKHR info = {.sType = VK_STRUCTURE_TYPE_SWAPCHAIN_CREATE_INFO_KHR,
                                         .surface = d->surface,
                                         .minImageCount = count,
                                         .imageFormat = chain->format.format,
                                         .imageColorSpace = chain->format.colorSpace,
                                         .imageExtent = {chain->width, chain->height},
                                         .imageArrayLayers = 1,
                                         .imageUsage = VK_IMAGE_USAGE_TRANSFER_DST_BIT,
                                         .preTransform = can->currentTransform,
                                         .compositeAlpha = alpha,
                                         .presentMode = choose_mode(d, wait_for_display),
                                         .clipped = VK_TRUE,
                                         .oldSwapchain = old};
  if (!gpu_check(d, d->CreateSwapchainKHR(d->host.device, &info, NULL, &chain->swapchain), "the window's swapchain"))
    return false;
  chain->image_count = VIEW_SWAPCHAIN_IMAGES;
  return gpu_check(d, d->GetSwapchainImagesKHR(d->host.device, chain->swapchain, &chain->image_count, chain->images),
                   "the window's images");
}

bool view_swapchain_create(gpu_device *d, uint32_t width, uint32_t height, bool wait_for_display,
                           view_swapchain *chain) {
  const VkSwapchainKHR old = chain->swapchain;
  const VkFenceCreateInfo fence = {.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
  if (!chain->acquired && !gpu_check(d, d->CreateFence(d->host.device, &fence, NULL, &chain->acquired), "a fence")) {
    return false;
  }
  VkSurfaceCapabilitiesKHR can;
  if (!gpu_check(d, d->DeviceWaitIdle(d->host.device), "waiting for the device")) return false;
  if (!gpu_check(d, d->GetPhysicalDeviceSurfaceCapabilitiesKHR(d->host.physical_device, d->surface, &can),
                 "the window"))
    return false;
  const bool free_size = can.currentExtent.width == UINT32_MAX;
  chain->width =
      between(free_size ? width : can.currentExtent.width, can.minImageExtent.width, can.maxImageExtent.width);
  chain->height =
      between(free_size ? height : can.currentExtent.height, can.minImageExtent.height, can.maxImageExtent.height);
  chain->swapchain = VK_NULL_HANDLE;
  chain->image_count = 0;
  chain->stale = false;
  const bool made = chain->width == 0 || chain->height == 0 ||
                    (choose_format(d, &chain->format) && make(d, &can, wait_for_display, chain, old));
  d->DestroySwapchainKHR(d->host.device, old, NULL);
  return made;
}

void view_swapchain_destroy(gpu_device *d, view_swapchain *chain) {
  if (!d->host.device) return;
  if (chain->swapchain) d->DestroySwapchainKHR(d->host.device, chain->swapchain, NULL);
  if (chain->acquired) d->DestroyFence(d->host.device, chain->acquired, NULL);
  *chain = (view_swapchain){.swapchain = VK_NULL_HANDLE};
}

bool view_swapchain_acquire(gpu_device *d, view_swapchain *chain, uint32_t *index) {
  *index = UINT32_MAX;
  if (!chain->swapchain) return true;
  const VkResult result =
      d->AcquireNextImageKHR(d->host.device, chain->swapchain, UINT64_MAX, VK_NULL_HANDLE, chain->acquired, index);
  chain->stale = chain->stale || result == VK_ERROR_OUT_OF_DATE_KHR || result == VK_SUBOPTIMAL_KHR;
  if (result == VK_ERROR_OUT_OF_DATE_KHR) {
    *index = UINT32_MAX;
    return true;
  }
  if (result != VK_SUBOPTIMAL_KHR && !gpu_check(d, result, "the window's next image")) return false;
  return gpu_check(d, d->WaitForFences(d->host.device, 1, &chain->acquired, VK_TRUE, UINT64_MAX),
                   "the window's image") &&
         gpu_check(d, d->ResetFences(d->host.device, 1, &chain->acquired), "a fence");
}

static void change(const gpu_device *d, VkCommandBuffer commands, VkImage image, VkImageLayout from, VkImageLayout to) {
  const VkImageMemoryBarrier barrier = {
      .sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER,
      .srcAccessMask = from == VK_IMAGE_LAYOUT_UNDEFINED ? 0 : VK_ACCESS_TRANSFER_WRITE_BIT,
      .dstAccessMask = from == VK_IMAGE_LAYOUT_UNDEFINED ? VK_ACCESS_TRANSFER_WRITE_BIT : 0,
      .oldLayout = from,
      .newLayout = to,
      .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
      .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
      .image = image,
      .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1}};
  d->CmdPipelineBarrier(commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_PIPELINE_STAGE_TRANSFER_BIT, 0, 0, NULL, 0, NULL,
                        1, &barrier);
}

void view_swapchain_record(const gpu_device *d, const view_swapchain *chain, uint32_t index, VkCommandBuffer commands,
                           const gpu_image *picture) {
  const VkImage image = chain->images[index];
  const VkImageBlit whole = {.srcSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                             .srcOffsets = {{0, 0, 0}, {(int32_t)picture->width, (int32_t)picture->height, 1}},
                             .dstSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                             .dstOffsets = {{0, 0, 0}, {(int32_t)chain->width, (int32_t)chain->height, 1}}};
  change(d, commands, image, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
  d->CmdBlitImage(commands, picture->image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, image,
                  VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &whole, VK_FILTER_NEAREST);
  change(d, commands, image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_IMAGE_LAYOUT_PRESENT_SRC_KHR);
}

bool view_swapchain_show(gpu_device *d, view_swapchain *chain, uint32_t index) {
  const VkPresentInfoKHR info = {.sType = VK_STRUCTURE_TYPE_PRESENT_INFO_KHR,
                                 .swapchainCount = 1,
                                 .pSwapchains = &chain->swapchain,
                                 .pImageIndices = &index};
  const VkResult result = d->QueuePresentKHR(d->host.queue, &info);
  chain->stale = chain->stale || result == VK_ERROR_OUT_OF_DATE_KHR || result == VK_SUBOPTIMAL_KHR;
  return result == VK_ERROR_OUT_OF_DATE_KHR || result == VK_SUBOPTIMAL_KHR || gpu_check(d, result, "showing a picture");
}
