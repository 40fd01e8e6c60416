// Records copies of changed texels from a buffer to a field's maps of light, in batches between two barriers.
#include "vulkan/map_copies.h"

static void barrier(const olx_vulkan_field *gpu, VkCommandBuffer commands, bool before) {
  const olx_gpu_maps *maps[2] = {&gpu->maps[OLX_BINDING_DIRECT - OLX_BINDING_RADIANCE],
                                 &gpu->maps[OLX_BINDING_INDIRECT - OLX_BINDING_RADIANCE]};
  const VkImageLayout read = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL, copy = VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL;
  VkImageMemoryBarrier barriers[2];
  for (uint32_t i = 0; i < 2; i++) {
    barriers[i] = (VkImageMemoryBarrier){
        .sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER,
        .srcAccessMask = before ? 0 : VK_ACCESS_TRANSFER_WRITE_BIT,
        .dstAccessMask = before ? VK_ACCESS_TRANSFER_WRITE_BIT : VK_ACCESS_SHADER_READ_BIT,
        .oldLayout = before ? read : copy,
        .newLayout = before ? copy : read,
        .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .image = maps[i]->image,
        .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, maps[i]->layers},
    };
  }
  const VkPipelineStageFlags all = VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, transfer = VK_PIPELINE_STAGE_TRANSFER_BIT;
  const VkMemoryBarrier words = {
      .sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER,
      .srcAccessMask = before ? 0 : VK_ACCESS_TRANSFER_WRITE_BIT,
      .dstAccessMask = before ? VK_ACCESS_TRANSFER_WRITE_BIT : VK_ACCESS_UNIFORM_READ_BIT | VK_ACCESS_SHADER_READ_BIT};
  gpu->context.vk.CmdPipelineBarrier(commands, before ? all : transfer, before ? transfer : all, 0, 1, &words, 0, NULL,
                                     2, barriers);
}

void olx_map_copies_begin(const olx_vulkan_field *gpu, VkCommandBuffer commands) { barrier(gpu, commands, true); }
void olx_map_copies_end(const olx_vulkan_field *gpu, VkCommandBuffer commands) { barrier(gpu, commands, false); }

olx_map_copies olx_map_copies_of(const olx_vulkan_field *gpu, uint32_t binding, VkBuffer buffer,
                                 VkCommandBuffer commands) {
  return (olx_map_copies){.context = &gpu->context,
                          .maps = &gpu->maps[binding - OLX_BINDING_RADIANCE],
                          .buffer = buffer,
                          .commands = commands};
}

void olx_map_copies_record(olx_map_copies *copies) {
  if (copies->count == 0) return;
  copies->context->vk.CmdCopyBufferToImage(copies->commands, copies->buffer, copies->maps->image,
                                           VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, copies->count, copies->regions);
  copies->count = 0;
}

void olx_map_copies_add(olx_map_copies *copies, uint32_t map, const olx_map_part *part, VkDeviceSize offset) {
  const olx_gpu_maps *maps = copies->maps;
  const uint32_t a_layer = maps->maps_a_side * maps->maps_a_side, in_layer = map % a_layer;
  if (copies->count == OLX_MAP_COPIES_BATCH) olx_map_copies_record(copies);
  copies->regions[copies->count++] = (VkBufferImageCopy){
      .bufferOffset = offset,
      .imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, map / a_layer, 1},
      .imageOffset = {(int32_t)(in_layer % maps->maps_a_side * maps->stride) + part->x + 1,
                      (int32_t)(in_layer / maps->maps_a_side * maps->stride) + part->y + 1, 0},
      .imageExtent = {part->width, part->height, 1},
  };
}
