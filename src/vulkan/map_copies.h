// Copies from a buffer to parts of a field's maps of direct and indirect light, in batches.
#ifndef OLX_VULKAN_MAP_COPIES_H
#define OLX_VULKAN_MAP_COPIES_H

#include "vulkan/vulkan_field.h"

enum { OLX_MAP_COPIES_BATCH = 64 };

typedef struct olx_map_copies {
  const olx_vulkan_context *context;
  const olx_gpu_maps *maps;
  VkBuffer buffer;
  VkCommandBuffer commands;
  uint32_t count; // added but not yet recorded
  VkBufferImageCopy regions[OLX_MAP_COPIES_BATCH];
} olx_map_copies;

// A rectangle of texels of a map, from (x, y) on, where -1 is the border.
typedef struct olx_map_part {
  int32_t x, y;
  uint32_t width, height;
} olx_map_part;

// Records the barriers around all copies of a command buffer, including those to words: copies wait for all earlier
// commands, and all later commands wait for the copies.
void olx_map_copies_begin(const olx_vulkan_field *gpu, VkCommandBuffer commands);
void olx_map_copies_end(const olx_vulkan_field *gpu, VkCommandBuffer commands);

// Begins a batch of copies to the maps of `binding`, OLX_BINDING_DIRECT or OLX_BINDING_INDIRECT.
olx_map_copies olx_map_copies_of(const olx_vulkan_field *gpu, uint32_t binding, VkBuffer buffer,
                                 VkCommandBuffer commands);
// Adds the copy of a rectangle whose texels lie row by row from `offset` on, in bytes.
void olx_map_copies_add(olx_map_copies *copies, uint32_t map, const olx_map_part *part, VkDeviceSize offset);
void olx_map_copies_record(olx_map_copies *copies);

#endif
