// A field on the device: one image for each kind of map, one buffer for all else, and the descriptor set of both.
#ifndef OLX_VULKAN_FIELD_H
#define OLX_VULKAN_FIELD_H

#include "field/field_data.h"
#include "vulkan/context.h"
#include "vulkan/gpu_structs.h"

enum {
  OLX_GPU_MAPS = OLX_FIELD_BINDINGS - OLX_BINDING_RADIANCE,
  OLX_POOL_ROW = 1 << OLX_POOL_ROW_BITS // blocks in a row of a pool's image, and most rows in a layer
};

// Returns the number of rows of blocks in a pool's image, all layers together.
static inline uint32_t olx_pool_rows(uint32_t blocks) {
  return blocks ? (blocks + OLX_POOL_ROW - 1) / OLX_POOL_ROW : 1;
}

// The maps of one kind: map i lies in layer i / maps_a_side^2 of an image, maps_a_side of them along each side.
typedef struct olx_gpu_maps {
  VkFormat format;
  uint32_t texel_bytes;                // bytes of a texel or of a block
  uint32_t stride;                     // of a map, in texels, border included; unused for pools
  uint32_t count, maps_a_side, layers; // `count` maps, or blocks of a pool
  bool filtered;
  bool pooled;          // the image has the blocks of a pool, row by row, instead of maps
  bool decoded;         // the field has blocks, but the image has texels
  olx_surface_map kind; // the map of surfaces
  const void *texels;   // in the file: texels, or the blocks of the pool
  VkImage image;
  VkImageView view;
  VkDeviceMemory memory;
  VkMemoryRequirements requirements;
} olx_gpu_maps;

// The parts of a field that shaders read as words of one buffer, in this order.
typedef enum olx_gpu_words_part {
  OLX_WORDS_LEAST = 0,
  OLX_WORDS_BRICKS,
  OLX_WORDS_VORONOI,
  OLX_WORDS_EMISSION,
  OLX_WORDS_TILES,
  OLX_WORDS_PLANES,
  OLX_WORDS_SURFACES, // tiles of each kind of map in turn
  OLX_WORDS_SURFACES_END = OLX_WORDS_SURFACES + OLX_SURFACE_MAPS - 1,
  OLX_WORDS_LIGHTS,
  OLX_WORDS_VOLUME,
  OLX_WORDS_VOLUME_LIGHT, // directly after it
  OLX_GPU_WORDS
} olx_gpu_words_part;

typedef struct olx_gpu_words {
  const void *data;    // in the file
  VkDeviceSize bytes;  // 0 for a part that the field lacks
  VkDeviceSize offset; // in the buffer
} olx_gpu_words;

struct olx_vulkan_field {
  olx_vulkan_context context;
  olx_field_constants constants;
  olx_gpu_maps maps[OLX_GPU_MAPS]; // in the order of the bindings
  VkBuffer buffer;                 // constants, probes, irradiance probes, and words
  VkDeviceMemory buffer_memory;
  VkMemoryRequirements buffer_requirements;
  VkDeviceSize probes_offset, irradiance_probes_offset, buffer_bytes;
  olx_gpu_words words[OLX_GPU_WORDS]; // one after the other, up to the end
  uint32_t light_room;                // number of lights for which the words have room
  VkSampler nearest, linear;
  VkDescriptorSetLayout set_layout;
  VkDescriptorPool pool;
  VkDescriptorSet set;
};

// Computes the device memory that olx_vulkan_classic_create would take; 0 for a field without classic maps (irradiance
// probes without visibility).
olx_result olx_vulkan_classic_measure(const olx_vulkan_context *context, const olx_field *field, uint64_t *bytes);

// Returns OLX_GEOMETRY_IN_TEXELS or OLX_GEOMETRY_IN_BLOCKS.
static inline uint32_t olx_gpu_field_geometry(const olx_vulkan_field *gpu) {
  return gpu->constants.geometry_scale > 0.0f ? OLX_GEOMETRY_IN_BLOCKS : OLX_GEOMETRY_IN_TEXELS;
}

// Returns whether the data that relighting changes has the same number and size on the device as in the field.
bool olx_gpu_field_relights(const olx_vulkan_field *gpu, const olx_field *field);

// Creates the layout of sets for pipelines that read a part of the field: the bindings in `mask`, bit (1 <<
// OLX_BINDING_*).
olx_result olx_gpu_field_set_layout(const olx_vulkan_context *context, uint32_t mask, VkDescriptorSetLayout *layout);
void olx_gpu_field_write_set(const olx_vulkan_field *gpu, uint32_t mask, VkDescriptorSet set);

// Fills a device's buffer and images, which vulkan_field.c has created.
olx_result olx_vulkan_field_upload(olx_vulkan_field *gpu, const olx_field *field);

#endif
