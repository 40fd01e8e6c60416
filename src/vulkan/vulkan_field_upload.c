// Uploads a field to the buffer and the images of vulkan_field.c, some rows of maps at a time, through the uploader's
// staging memory.
#include "field/field_file.h"
#include "vulkan/uploader.h"
#include "vulkan/vulkan_field.h"

static void transition(const olx_vulkan_field *gpu, VkCommandBuffer commands, VkImageLayout from, VkImageLayout to) {
  const bool first = from == VK_IMAGE_LAYOUT_UNDEFINED;
  VkImageMemoryBarrier barriers[OLX_GPU_MAPS];
  for (uint32_t i = 0; i < OLX_GPU_MAPS; i++) {
    barriers[i] = (VkImageMemoryBarrier){
        .sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER,
        .srcAccessMask = first ? 0 : VK_ACCESS_TRANSFER_WRITE_BIT,
        .dstAccessMask = first ? VK_ACCESS_TRANSFER_WRITE_BIT : VK_ACCESS_SHADER_READ_BIT,
        .oldLayout = from,
        .newLayout = to,
        .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .image = gpu->maps[i].image,
        .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, gpu->maps[i].layers},
    };
  }
  const VkMemoryBarrier buffer = {.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER,
                                  .srcAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT,
                                  .dstAccessMask = VK_ACCESS_UNIFORM_READ_BIT | VK_ACCESS_SHADER_READ_BIT};
  gpu->context.vk.CmdPipelineBarrier(commands,
                                     first ? VK_PIPELINE_STAGE_TOP_OF_PIPE_BIT : VK_PIPELINE_STAGE_TRANSFER_BIT,
                                     first ? VK_PIPELINE_STAGE_TRANSFER_BIT : VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, 0,
                                     first ? 0 : 1, &buffer, 0, NULL, OLX_GPU_MAPS, barriers);
}

// Fills memory with rows of texels, copied from the file or decoded.
static void fill_rows(const olx_field *field, const olx_gpu_maps *maps, uint32_t map, uint32_t row, uint32_t rows,
                      uint32_t row_bytes, unsigned char *memory) {
  if (!maps->decoded) {
    memcpy(memory, (const char *)maps->texels + ((size_t)maps->stride * map + row) * row_bytes,
           (size_t)rows * row_bytes);
    return;
  }
  for (uint32_t i = 0; i < rows; i++) {
    olx_surface_row(field, maps->kind, map, row + i, memory + (size_t)i * row_bytes);
  }
}

// Uploads the rows of one map, as many at a time as fit into the staging slot.
static olx_result upload_map(olx_vulkan_field *gpu, const olx_field *field, olx_uploader *uploader,
                             const olx_gpu_maps *maps, uint32_t map) {
  const uint32_t all = maps->stride, row_bytes = all * maps->texel_bytes, most = OLX_STAGING_SLOT_BYTES / row_bytes;
  const uint32_t maps_a_layer = maps->maps_a_side * maps->maps_a_side, in_layer = map % maps_a_layer;
  for (uint32_t row = 0; row < all;) {
    const uint32_t rest = all - row, rows = rest < most ? rest : most;
    void *memory;
    VkDeviceSize offset;
    VkCommandBuffer commands;
    OLX_TRY(olx_uploader_reserve(uploader, rows * row_bytes, &memory, &offset, &commands));
    fill_rows(field, maps, map, row, rows, row_bytes, memory);
    const VkBufferImageCopy region = {
        .bufferOffset = offset,
        .imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, map / maps_a_layer, 1},
        .imageOffset = {(int32_t)(in_layer % maps->maps_a_side * maps->stride),
                        (int32_t)(in_layer / maps->maps_a_side * maps->stride + row), 0},
        .imageExtent = {maps->stride, rows, 1},
    };
    gpu->context.vk.CmdCopyBufferToImage(commands, uploader->staging.buffer, maps->image,
                                         VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &region);
    row += rows;
  }
  return OLX_OK;
}

// Fills memory with rows of a pool's blocks, from block `first` on. What follows the last block is 0.
static void fill_pool_rows(const olx_field *field, const olx_gpu_maps *maps, uint32_t first, uint32_t rows,
                           size_t row_bytes, unsigned char *memory) {
  memset(memory, 0, rows * row_bytes);
  for (uint32_t i = 0; i < rows && first < maps->count; i++, first += OLX_POOL_ROW) {
    const uint32_t rest = maps->count - first, count = rest < OLX_POOL_ROW ? rest : OLX_POOL_ROW;
    unsigned char *row = memory + i * row_bytes;
    if (!maps->decoded) {
      memcpy(row, (const char *)maps->texels + (size_t)first * maps->texel_bytes, (size_t)count * maps->texel_bytes);
      continue;
    }
    for (uint32_t y = 0; y < OLX_BLOCK_SIDE; y++) {
      olx_pool_row(field, maps->kind, first, count, y, row + row_bytes / OLX_BLOCK_SIDE * y);
    }
  }
}

// Uploads the blocks of a pool, as many rows of a layer at a time as fit into the staging slot.
static olx_result upload_pool(olx_vulkan_field *gpu, const olx_field *field, olx_uploader *uploader,
                              const olx_gpu_maps *maps) {
  const uint32_t all = olx_pool_rows(maps->count), texels = maps->decoded ? OLX_BLOCK_SIDE * OLX_BLOCK_SIDE : 1,
                 row_bytes = OLX_POOL_ROW * texels * maps->texel_bytes, most = OLX_STAGING_SLOT_BYTES / row_bytes;
  for (uint32_t row = 0; row < all;) {
    const uint32_t in_layer = row % OLX_POOL_ROW, whole = OLX_POOL_ROW - in_layer,
                   rest = all - row < whole ? all - row : whole, rows = rest < most ? rest : most;
    void *memory;
    VkDeviceSize offset;
    VkCommandBuffer commands;
    OLX_TRY(olx_uploader_reserve(uploader, rows * row_bytes, &memory, &offset, &commands));
    fill_pool_rows(field, maps, row * OLX_POOL_ROW, rows, row_bytes, memory);
    const VkBufferImageCopy region = {
        .bufferOffset = offset,
        .imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, row / OLX_POOL_ROW, 1},
        .imageOffset = {0, (int32_t)(in_layer * OLX_BLOCK_SIDE), 0},
        .imageExtent = {OLX_POOL_ROW * OLX_BLOCK_SIDE, rows * OLX_BLOCK_SIDE, 1},
    };
    gpu->context.vk.CmdCopyBufferToImage(commands, uploader->staging.buffer, maps->image,
                                         VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &region);
    row += rows;
  }
  return OLX_OK;
}

static olx_result upload_maps(olx_vulkan_field *gpu, const olx_field *field, olx_uploader *uploader,
                              const olx_gpu_maps *maps) {
  if (maps->pooled) return upload_pool(gpu, field, uploader, maps);
  for (uint32_t map = 0; map < maps->count; map++) OLX_TRY(upload_map(gpu, field, uploader, maps, map));
  return OLX_OK;
}

static olx_result upload_probes(olx_vulkan_field *gpu, olx_uploader *uploader, const olx_vec3 *positions,
                                const uint8_t *flags, uint32_t count, VkDeviceSize to) {
  olx_gpu_probe probes[256];
  const uint32_t most = sizeof probes / sizeof probes[0];
  for (uint32_t first = 0; first < count; first += most) {
    const uint32_t part = count - first < most ? count - first : most;
    for (uint32_t i = 0; i < part; i++) {
      const olx_vec3 p = positions[first + i];
      probes[i] = (olx_gpu_probe){p.x, p.y, p.z, flags[first + i]};
    }
    OLX_TRY(olx_uploader_copy(uploader, probes, part * sizeof probes[0], gpu->buffer, to + first * sizeof probes[0]));
  }
  return OLX_OK;
}

static olx_result upload_everything(olx_vulkan_field *gpu, const olx_field *field, olx_uploader *uploader) {
  void *memory;
  VkDeviceSize offset;
  VkCommandBuffer commands;
  OLX_TRY(olx_uploader_reserve(uploader, 0, &memory, &offset, &commands));
  transition(gpu, commands, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
  OLX_TRY(olx_uploader_copy(uploader, &gpu->constants, sizeof gpu->constants, gpu->buffer, 0));
  OLX_TRY(upload_probes(gpu, uploader, field->probe_positions, field->probe_flags, field->info.probes.count,
                        gpu->probes_offset));
  OLX_TRY(upload_probes(gpu, uploader, field->irradiance_positions, field->irradiance_flags,
                        field->info.irradiance.probe_count, gpu->irradiance_probes_offset));
  for (uint32_t i = 0; i < OLX_GPU_WORDS; i++) {
    const olx_gpu_words *part = &gpu->words[i];
    OLX_TRY(olx_uploader_copy(uploader, part->data, part->bytes, gpu->buffer, part->offset));
  }
  for (uint32_t i = 0; i < OLX_GPU_MAPS; i++) OLX_TRY(upload_maps(gpu, field, uploader, &gpu->maps[i]));
  OLX_TRY(olx_uploader_reserve(uploader, 0, &memory, &offset, &commands));
  transition(gpu, commands, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL);
  return olx_uploader_finish(uploader);
}

olx_result olx_vulkan_field_upload(olx_vulkan_field *gpu, const olx_field *field) {
  olx_uploader uploader;
  olx_result result = olx_uploader_begin(&gpu->context, &uploader);
  if (result == OLX_OK) result = upload_everything(gpu, field, &uploader);
  olx_uploader_end(&uploader);
  return result;
}
