// A relighter on the device: its buffers, sets and pipelines. gpu_relight.c makes them, relight_fill.c lays out and
// fills the buffers, relight_frame.c records frames. docs/relighting.md, "On Vulkan".
#ifndef OLX_VULKAN_GPU_RELIGHT_H
#define OLX_VULKAN_GPU_RELIGHT_H

#include "shade/relighter.h"
#include "vulkan/gpu_frame.h"

enum { OLX_RELIGHT_MOST_IN_FLIGHT = 8 };

typedef enum olx_relight_pass {
  OLX_PASS_BEGIN = 0,
  OLX_PASS_DIRECT,
  OLX_PASS_REFLECT,
  OLX_PASS_EXACT,
  OLX_PASS_POINTS,
  OLX_PASS_PREDICT,
  OLX_PASS_GATHER,
  OLX_PASS_ADVANCE,
  OLX_PASS_FINISH,
  OLX_PASS_PACK,
  OLX_RELIGHT_PASSES
} olx_relight_pass;

// Passes that see the same buffers and the same part of the field.
typedef enum olx_relight_group {
  OLX_GROUP_TRACE = 0, // begin, direct
  OLX_GROUP_LOOKUP,    // reflect
  OLX_GROUP_MAPS,      // the others
  OLX_RELIGHT_GROUPS
} olx_relight_group;

typedef struct olx_gpu_group {
  VkDescriptorSetLayout own_layout, field_layout;
  VkPipelineLayout layout;
  VkDescriptorSet own[2], field; // own: with surfaces as places, and with texels
} olx_gpu_group;

typedef enum olx_relight_buffer {
  OLX_BUFFER_STATE = 0,
  OLX_BUFFER_SURFACES,
  OLX_BUFFER_TEXELS,
  OLX_BUFFER_RADIANCE,
  OLX_BUFFER_FIT,
  OLX_BUFFER_PACKED,
  OLX_BUFFER_RESULTS, // host-visible: change and mean of each map, `in_flight` times
  OLX_RELIGHT_BUFFERS
} olx_relight_buffer;

typedef struct olx_relight_storage {
  uint64_t words;
  VkBuffer buffer;
  VkDeviceMemory memory;
  VkMemoryRequirements requirements;
} olx_relight_storage;

// Words of the state before what its offsets count.
#define OLX_RELIGHT_HEADER_WORDS ((uint32_t)(sizeof(olx_gpu_relight) / sizeof(uint32_t)))

// Numbers of what a dispatch does.
enum {
  OLX_CALL_SURFACES = 0, // begin their light, or reflect it
  OLX_CALL_TEXELS,
  OLX_CALL_RESIDUAL,
  OLX_CALL_MULTIPLY,
  OLX_CALL_ADVANCE, // and the next one, by which norm was there before
  OLX_CALL_TURN = OLX_CALL_ADVANCE + 2,
  OLX_CALL_RAYS = OLX_CALL_TURN + 2, // of surfaces, then of texels: olx_relight_rays_call
  OLX_RELIGHT_RAYS = 4               // of a place in one dispatch: some devices bound the time or the loops of one
};

// Points that an unknown of the fit depends on: rows of the transpose, one an unknown.
typedef struct olx_fit_transpose {
  uint32_t *starts;  // of rows, and the end
  uint32_t *entries; // a point, and the bits of its weight
} olx_fit_transpose;

struct olx_vulkan_relight {
  olx_vulkan_field *gpu;
  olx_relight *relight;
  olx_vulkan_relight_settings settings;
  olx_gpu_relight constants;
  olx_relight_storage buffers[OLX_RELIGHT_BUFFERS];
  const float *results; // mapped
  olx_gpu_group groups[OLX_RELIGHT_GROUPS];
  VkDescriptorPool pool;
  VkPipeline pipelines[OLX_RELIGHT_PASSES];
  uint32_t *jobs;  // words of a frame's jobs, before they go to the device
  uint32_t *packs; // irradiance maps that a frame packs
  uint32_t pack_count;
  uint32_t light_changes; // of the relighter, that the device knows of
  uint32_t slot;          // of the results
  bool written[OLX_RELIGHT_MOST_IN_FLIGHT];
};

// How many dispatches the rays to so many lights take, and the number of one of them.
static inline uint32_t olx_relight_chunks(const olx_relight *r, uint32_t lights) {
  return (lights * r->settings.light_samples + OLX_RELIGHT_RAYS - 1) / OLX_RELIGHT_RAYS;
}
static inline uint32_t olx_relight_rays_call(const olx_relight *r, bool texels, uint32_t chunk) {
  return OLX_CALL_RAYS + (texels ? olx_relight_chunks(r, OLX_RELIT_MOST_LIGHTS) : 0) + chunk;
}

// What lies where, and how many words each buffer has.
void olx_relight_lay_out(olx_vulkan_relight *relight);
// The buffers' contents, from the relighter.
olx_result olx_relight_fill(olx_vulkan_relight *relight);

#endif
