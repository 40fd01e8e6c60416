// Copies bytes to a device through two slots of host-visible memory, one of which is filled while the other is copied.
#include "vulkan/uploader.h"

#include <string.h>

static const char WHAT[] = "uploading a field";

olx_result olx_uploader_begin(const olx_vulkan_context *c, olx_uploader *u) {
  *u = (olx_uploader){.context = c};
  const VkDeviceSize bytes = (VkDeviceSize)OLX_STAGING_SLOTS * OLX_STAGING_SLOT_BYTES;
  OLX_TRY(olx_staging_create(c, bytes, WHAT, &u->staging));
  const VkCommandPoolCreateInfo pool = {.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                        .flags = VK_COMMAND_POOL_CREATE_TRANSIENT_BIT |
                                                 VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT,
                                        .queueFamilyIndex = c->host.queue_family};
  OLX_TRY(
      olx_vulkan_check(c->vk.CreateCommandPool(c->host.device, &pool, NULL, &u->pool), "vkCreateCommandPool", WHAT));
  const VkCommandBufferAllocateInfo commands = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                                .commandPool = u->pool,
                                                .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
                                                .commandBufferCount = OLX_STAGING_SLOTS};
  OLX_TRY(olx_vulkan_check(c->vk.AllocateCommandBuffers(c->host.device, &commands, u->commands),
                           "vkAllocateCommandBuffers", WHAT));
  for (uint32_t i = 0; i < OLX_STAGING_SLOTS; i++) {
    const VkFenceCreateInfo fence = {.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
    OLX_TRY(olx_vulkan_check(c->vk.CreateFence(c->host.device, &fence, NULL, &u->fences[i]), "vkCreateFence", WHAT));
  }
  return OLX_OK;
}

static olx_result wait_for_slot(olx_uploader *u, uint32_t slot) {
  if (!u->pending[slot]) return OLX_OK;
  const olx_vulkan_context *c = u->context;
  OLX_TRY(olx_vulkan_check(c->vk.WaitForFences(c->host.device, 1, &u->fences[slot], VK_TRUE, UINT64_MAX),
                           "vkWaitForFences", WHAT));
  u->pending[slot] = false; // only now, so that what a failed wait leaves in use is waited for again at the end
  return olx_vulkan_check(c->vk.ResetFences(c->host.device, 1, &u->fences[slot]), "vkResetFences", WHAT);
}

static olx_result submit(olx_uploader *u) {
  const olx_vulkan_context *c = u->context;
  if (!u->recording) return OLX_OK;
  u->recording = false;
  OLX_TRY(olx_vulkan_check(c->vk.EndCommandBuffer(u->commands[u->slot]), "vkEndCommandBuffer", WHAT));
  const VkSubmitInfo info = {
      .sType = VK_STRUCTURE_TYPE_SUBMIT_INFO, .commandBufferCount = 1, .pCommandBuffers = &u->commands[u->slot]};
  OLX_TRY(olx_vulkan_check(c->vk.QueueSubmit(c->host.queue, 1, &info, u->fences[u->slot]), "vkQueueSubmit", WHAT));
  u->pending[u->slot] = true;
  u->slot = (u->slot + 1) % OLX_STAGING_SLOTS;
  return OLX_OK;
}

olx_result olx_uploader_reserve(olx_uploader *u, uint32_t bytes, void **memory, VkDeviceSize *offset,
                                VkCommandBuffer *commands) {
  const olx_vulkan_context *c = u->context;
  if (u->recording && u->used + bytes > OLX_STAGING_SLOT_BYTES) OLX_TRY(submit(u));
  if (!u->recording) {
    OLX_TRY(wait_for_slot(u, u->slot));
    const VkCommandBufferBeginInfo info = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                           .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
    OLX_TRY(olx_vulkan_check(c->vk.BeginCommandBuffer(u->commands[u->slot], &info), "vkBeginCommandBuffer", WHAT));
    u->recording = true;
    u->used = 0;
  }
  *offset = (VkDeviceSize)u->slot * OLX_STAGING_SLOT_BYTES + u->used;
  *memory = u->staging.mapped + *offset;
  *commands = u->commands[u->slot];
  u->used += (bytes + 15u) & ~15u;
  return OLX_OK;
}

olx_result olx_uploader_copy(olx_uploader *u, const void *data, VkDeviceSize bytes, VkBuffer buffer, VkDeviceSize to) {
  for (VkDeviceSize done = 0; done < bytes;) {
    const VkDeviceSize rest = bytes - done;
    const uint32_t part = rest < OLX_STAGING_SLOT_BYTES ? (uint32_t)rest : OLX_STAGING_SLOT_BYTES;
    void *memory;
    VkDeviceSize offset;
    VkCommandBuffer commands;
    OLX_TRY(olx_uploader_reserve(u, part, &memory, &offset, &commands));
    memcpy(memory, (const char *)data + done, part);
    const VkBufferCopy region = {offset, to + done, part};
    u->context->vk.CmdCopyBuffer(commands, u->staging.buffer, buffer, 1, &region);
    done += part;
  }
  return OLX_OK;
}

olx_result olx_uploader_finish(olx_uploader *u) {
  OLX_TRY(submit(u));
  for (uint32_t i = 0; i < OLX_STAGING_SLOTS; i++) OLX_TRY(wait_for_slot(u, i));
  return OLX_OK;
}

void olx_uploader_end(olx_uploader *u) {
  const olx_vulkan_context *c = u->context;
  for (uint32_t i = 0; i < OLX_STAGING_SLOTS; i++) {
    if (u->pending[i]) c->vk.WaitForFences(c->host.device, 1, &u->fences[i], VK_TRUE, UINT64_MAX);
    c->vk.DestroyFence(c->host.device, u->fences[i], NULL);
  }
  c->vk.DestroyCommandPool(c->host.device, u->pool, NULL);
  olx_staging_destroy(c, &u->staging);
}
