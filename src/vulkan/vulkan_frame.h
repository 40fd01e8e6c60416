// The passes for one set of the host's images.
#ifndef OLX_VULKAN_FRAME_H
#define OLX_VULKAN_FRAME_H

#include "vulkan/vulkan_field.h"
#include "vulkan/gpu_history.h"

// The passes, in the order of OLX_VULKAN_PASS_*.
typedef enum olx_pass {
  OLX_PASS_IRRADIANCE = 0,
  OLX_PASS_DIFFUSE,
  OLX_PASS_TRACE,
  OLX_PASS_COMPOSITE,
  OLX_PASS_DIM, // follows OLX_PASS_TRACE: the pixels whose lobe is dim
  OLX_PASS_COUNT
} olx_pass;

// The SPIR-V of a pass, built from shaders/pass.
typedef struct olx_pass_code {
  const char *name;
  const uint32_t *words;
  size_t bytes;
} olx_pass_code;

extern const olx_pass_code olx_irradiance_pass, olx_diffuse_pass, olx_trace_pass, olx_composite_pass, olx_dim_pass,
    olx_accumulate_pass, olx_filter_pass;

// The specialisation constants of a pipeline.
typedef struct olx_pass_constants {
  olx_tracer tracer;
  olx_select select; // one that olx_vulkan_field_select returns
  uint32_t hits;     // olx_hits
  uint32_t geometry; // OLX_GEOMETRY_IN_*
} olx_pass_constants;

// Numbers of tracers, of selectors that olx_vulkan_field_select may return, and of kinds of light at the end of rays.
enum {
  OLX_GPU_TRACERS = OLX_TRACER_HIZ + 1,
  OLX_GPU_SELECTS = OLX_SELECT_EXHAUSTIVE + 1,
  OLX_GPU_HITS = OLX_HITS_STORED + 1
};

// The denoiser of a frame that has a history. Members in pairs alternate from frame to frame.
typedef struct olx_gpu_denoiser {
  VkDescriptorSetLayout accumulate_set_layout, filter_set_layout;
  VkPipelineLayout accumulate_layout, filter_layout;
  VkPipeline accumulate, filter;
  VkDescriptorPool pool;
  VkDescriptorSet accumulate_sets[2], filter_sets[2][2]; // first of the diffuse lobe, then of the glossy one
} olx_gpu_denoiser;

struct olx_vulkan_frame {
  olx_vulkan_field *field;
  uint32_t width, height;
  uint32_t image_flags; // OLX_FRAME_*: the images that the host provides, and those that hold normals as 0..1
  VkDescriptorSetLayout set_layout, sample_set_layout;
  VkPipelineLayout layout;
  // VK_NULL_HANDLE where the host wants no pipeline. Passes that trace no rays have one, at 0, 0 and 0.
  VkPipeline pipelines[OLX_PASS_COUNT][OLX_GPU_TRACERS][OLX_GPU_SELECTS][OLX_GPU_HITS];
  uint32_t passes; // bits 1 << olx_pass of the passes with a pipeline
  VkDescriptorPool pool;
  VkDescriptorSet set, sample_sets[2][2]; // by lobe and by alternate frame
  olx_gpu_history history;
  olx_gpu_denoiser denoiser;
};

// Creates the layout of a set: sampled images at bindings before `first_storage`, storage images from there on.
olx_result olx_gpu_set_layout_create(const olx_vulkan_context *context, uint32_t bindings, uint32_t first_storage,
                                     VkDescriptorSetLayout *layout);
olx_result olx_gpu_layout_create(const olx_vulkan_context *context, uint32_t set_count,
                                 const VkDescriptorSetLayout *sets, uint32_t constant_bytes, VkPipelineLayout *layout);
// Creates a pipeline; where `constants` is NULL, it has the shader's defaults.
olx_result olx_gpu_pipeline_create(const olx_vulkan_context *context, const olx_pass_code *code,
                                   const olx_pass_constants *constants, VkPipelineLayout layout, VkPipeline *pipeline);
olx_result olx_gpu_pool_create(const olx_vulkan_context *context, uint32_t sets, uint32_t sampled, uint32_t stored,
                               VkDescriptorPool *pool);
olx_result olx_gpu_set_allocate(const olx_vulkan_context *context, VkDescriptorPool pool, VkDescriptorSetLayout layout,
                                VkDescriptorSet *set);
void olx_gpu_set_write(const olx_vulkan_context *context, VkDescriptorSet set, uint32_t bindings,
                       uint32_t first_storage, const VkDescriptorImageInfo *images);

// Creates the denoiser. After a failure olx_gpu_denoiser_destroy must still be called.
olx_result olx_gpu_denoiser_create(olx_vulkan_frame *frame);
void olx_gpu_denoiser_destroy(olx_vulkan_frame *frame);
// Binds the frame's history and the host's images to the sets.
void olx_gpu_denoiser_write(olx_vulkan_frame *frame, const olx_vulkan_targets *targets);
// Returns the flags (OLX_TURN_*) that say which pixels trace rays in a frame.
uint32_t olx_gpu_turn_flags(const olx_vulkan_denoise *denoise);

// Checks that all settings are in range and that the frame has the histories that they need.
olx_result olx_vulkan_check_settings(const olx_vulkan_frame *frame, const olx_vulkan_settings *settings);
// Checks the settings by olx_vulkan_check_settings, and that the frame has the pass.
olx_result olx_vulkan_check_pass(const olx_vulkan_frame *frame, olx_pass pass, const olx_vulkan_settings *settings);

olx_frame_constants olx_gpu_frame_constants(const olx_vulkan_frame *frame, const olx_vulkan_view *view,
                                      const olx_vulkan_settings *settings, uint32_t flags);
olx_result olx_vulkan_record_pass(const olx_vulkan_frame *frame, olx_pass pass, VkCommandBuffer commands,
                                  const olx_vulkan_view *view, const olx_vulkan_settings *settings, uint32_t flags);
// Returns the reflectance below which lobes are dim; 0: none is, as where rays find emitters, which irradiance leaves
// out.
static inline float olx_vulkan_dim_lobe(const olx_vulkan_settings *settings) {
  return settings->sample.emitters ? 0.0f : settings->dim_lobe;
}

// Records a pass that traces rays of a lobe, and stores their samples for the denoiser if the settings say so.
olx_result olx_vulkan_record_rays(const olx_vulkan_frame *frame, olx_pass pass, uint32_t lobe, VkCommandBuffer commands,
                                  const olx_vulkan_view *view, const olx_vulkan_settings *settings);
void olx_vulkan_dispatch(const olx_vulkan_frame *frame, VkCommandBuffer commands);

#endif
