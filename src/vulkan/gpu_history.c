// Creates the images in which the denoiser stores surfaces and light from frame to frame, and orders their uses by
// barriers.
#include "vulkan/gpu_history.h"

static const char WHAT[] = "a frame's history";

// Returns a format that every device can sample and store.
static VkFormat format_of(uint32_t kind) {
  return kind == OLX_HISTORY_GUIDE ? VK_FORMAT_R32G32B32A32_UINT : VK_FORMAT_R16G16B16A16_SFLOAT;
}

bool olx_gpu_history_has(const olx_gpu_history *h, uint32_t kind) {
  switch (kind) {
  case OLX_HISTORY_GUIDE: return h->lobes != 0;
  case OLX_HISTORY_DIFFUSE: return h->lobes & OLX_VULKAN_LOBE_DIFFUSE;
  default: return h->lobes & OLX_VULKAN_LOBE_GLOSSY;
  }
}

static olx_result create_image(const olx_vulkan_context *c, uint32_t width, uint32_t height, uint32_t kind,
                               VkImage *image) {
  const VkImageCreateInfo info = {.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
                                  .imageType = VK_IMAGE_TYPE_2D,
                                  .format = format_of(kind),
                                  .extent = {width, height, 1},
                                  .mipLevels = 1,
                                  .arrayLayers = 1,
                                  .samples = VK_SAMPLE_COUNT_1_BIT,
                                  .tiling = VK_IMAGE_TILING_OPTIMAL,
                                  .usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_STORAGE_BIT};
  return olx_vulkan_check(c->vk.CreateImage(c->host.device, &info, NULL, image), "vkCreateImage", WHAT);
}

olx_result olx_gpu_history_begin(const olx_vulkan_context *c, uint32_t width, uint32_t height, uint32_t lobes,
                                 olx_gpu_history *h) {
  *h = (olx_gpu_history){.lobes = lobes, .requirements = {.memoryTypeBits = UINT32_MAX}};
  const uint32_t most = c->limits.maxImageDimension2D;
  if (lobes && (width > most || height > most)) {
    return olx_fail(OLX_ERROR_UNSUPPORTED, "%s: the device has no images of %u x %u pixels", WHAT, width, height);
  }
  for (uint32_t kind = 0; kind < OLX_HISTORY_KINDS; kind++) {
    for (uint32_t i = 0; i < 2 && olx_gpu_history_has(h, kind); i++) {
      OLX_TRY(create_image(c, width, height, kind, &h->images[kind][i]));
      VkMemoryRequirements needed;
      c->vk.GetImageMemoryRequirements(c->host.device, h->images[kind][i], &needed);
      h->offsets[kind][i] = (h->requirements.size + needed.alignment - 1) / needed.alignment * needed.alignment;
      h->requirements.size = h->offsets[kind][i] + needed.size;
      h->requirements.memoryTypeBits &= needed.memoryTypeBits;
    }
  }
  return OLX_OK;
}

static olx_result bind_image(const olx_vulkan_context *c, olx_gpu_history *h, uint32_t kind, uint32_t i) {
  OLX_TRY(olx_vulkan_check(c->vk.BindImageMemory(c->host.device, h->images[kind][i], h->memory, h->offsets[kind][i]),
                           "vkBindImageMemory", WHAT));
  const VkImageViewCreateInfo view = {.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
                                      .image = h->images[kind][i],
                                      .viewType = VK_IMAGE_VIEW_TYPE_2D,
                                      .format = format_of(kind),
                                      .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1}};
  return olx_vulkan_check(c->vk.CreateImageView(c->host.device, &view, NULL, &h->views[kind][i]), "vkCreateImageView",
                          WHAT);
}

olx_result olx_gpu_history_allocate(const olx_vulkan_context *c, olx_gpu_history *h) {
  if (!h->lobes) return OLX_OK;
  OLX_TRY(olx_vulkan_allocate(c, &h->requirements, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, WHAT, &h->memory));
  for (uint32_t kind = 0; kind < OLX_HISTORY_KINDS; kind++) {
    for (uint32_t i = 0; i < 2 && olx_gpu_history_has(h, kind); i++) OLX_TRY(bind_image(c, h, kind, i));
  }
  return OLX_OK;
}

void olx_gpu_history_destroy(const olx_vulkan_context *c, olx_gpu_history *h) {
  for (uint32_t kind = 0; kind < OLX_HISTORY_KINDS; kind++) {
    for (uint32_t i = 0; i < 2; i++) {
      c->vk.DestroyImageView(c->host.device, h->views[kind][i], NULL);
      c->vk.DestroyImage(c->host.device, h->images[kind][i], NULL);
    }
  }
  c->vk.FreeMemory(c->host.device, h->memory, NULL);
  *h = (olx_gpu_history){.lobes = 0};
}

void olx_gpu_history_barrier(const olx_vulkan_context *c, const olx_gpu_history *h, uint32_t kind, bool begins,
                             VkCommandBuffer commands) {
  const VkAccessFlags all = VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT;
  const VkMemoryBarrier memory = {
      .sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER, .srcAccessMask = VK_ACCESS_SHADER_WRITE_BIT, .dstAccessMask = all};
  VkImageMemoryBarrier images[2];
  for (uint32_t i = 0; i < 2; i++) {
    images[i] = (VkImageMemoryBarrier){.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER,
                                       .srcAccessMask = VK_ACCESS_SHADER_WRITE_BIT,
                                       .dstAccessMask = all,
                                       .oldLayout = VK_IMAGE_LAYOUT_UNDEFINED,
                                       .newLayout = VK_IMAGE_LAYOUT_GENERAL,
                                       .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                                       .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                                       .image = h->images[kind][i],
                                       .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1}};
  }
  c->vk.CmdPipelineBarrier(commands, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, 0, 1,
                           &memory, 0, NULL, begins ? 2 : 0, images);
}
