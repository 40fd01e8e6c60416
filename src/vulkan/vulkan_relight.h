// A relighter on the device: its buffers, sets and pipelines (docs/relighting.md, "Frames on the device").
// vulkan_relight.c creates them, relight_fill.c lays out and fills the buffers, and relight_frame.c records frames.
#ifndef OLX_VULKAN_RELIGHT_H
#define OLX_VULKAN_RELIGHT_H

#include "relight/relit_lights.h"
#include "relight/relit_schedule.h"
#include "vulkan/vulkan_frame.h"

enum { OLX_RELIGHT_MOST_IN_FLIGHT = 8 };

typedef enum olx_relight_pass {
  OLX_RELIGHT_SURFELS = 0,
  OLX_RELIGHT_VALUES,
  OLX_RELIGHT_BOUNCE,
  OLX_RELIGHT_TEXELS,
  OLX_RELIGHT_INTERPOLATE,
  OLX_RELIGHT_VOLUME,
  OLX_RELIGHT_PASSES
} olx_relight_pass;

// Groups of passes that use the same buffers and the same part of the field.
typedef enum olx_relight_group { OLX_GROUP_SURFELS = 0, OLX_GROUP_SITES, OLX_RELIGHT_GROUPS } olx_relight_group;

static inline olx_relight_group olx_relight_group_of(uint32_t pass) {
  return pass < OLX_RELIGHT_INTERPOLATE ? OLX_GROUP_SURFELS : OLX_GROUP_SITES;
}

typedef struct olx_gpu_group {
  VkDescriptorSetLayout own_layout, field_layout;
  VkPipelineLayout layout;
  VkDescriptorSet own, field;
} olx_gpu_group;

typedef enum olx_relight_buffer {
  OLX_BUFFER_STATE = 0,
  OLX_BUFFER_SURFELS, // and their links
  OLX_BUFFER_SITES,   // and the links of volume probes
  OLX_BUFFER_RESULTS, // host-visible: sums of change and light, for each of `in_flight` frames
  OLX_RELIGHT_BUFFERS
} olx_relight_buffer;

typedef struct olx_relight_storage {
  uint64_t words;
  VkBuffer buffer;
  VkDeviceMemory memory;
  VkMemoryRequirements requirements;
} olx_relight_storage;

// The number of words of the state before the first word to which its offsets refer.
#define OLX_RELIGHT_HEADER_WORDS ((uint32_t)(sizeof(olx_gpu_relight) / sizeof(uint32_t)))

_Static_assert(sizeof(olx_relit_tile) == OLX_TILE_WORDS * sizeof(uint32_t), "a tile is uploaded as it is");

// The turns whose results a slot holds.
typedef struct olx_relight_reading {
  bool written;
  olx_relit_link_turns turns;
} olx_relight_reading;

struct olx_vulkan_relight {
  olx_vulkan_field *gpu;
  olx_relit_schedule *schedule;   // of the relighter, handed over
  const olx_relit_lights *lights; // of the relighter
  olx_vulkan_relight_settings settings;
  olx_gpu_relight constants;
  olx_relight_storage buffers[OLX_RELIGHT_BUFFERS];
  const float *results;  // mapped memory
  uint32_t result_words; // of one slot
  olx_gpu_group groups[OLX_RELIGHT_GROUPS];
  VkDescriptorPool pool;
  VkPipeline pipelines[OLX_RELIGHT_PASSES];
  uint32_t light_changes; // the schedule's count up to which the device has the relighter's lights
  uint32_t slot;          // the current slot of the results
  olx_relight_reading readings[OLX_RELIGHT_MOST_IN_FLIGHT];
};

// Computes the offsets in the buffers and the number of words of each.
void olx_gpu_relight_lay_out(olx_vulkan_relight *v, const olx_relight *relight);
// Fills the buffers with the structure of a relighter's field and its present light.
olx_result olx_gpu_relight_fill(olx_vulkan_relight *v, const olx_relight *relight);

#endif
