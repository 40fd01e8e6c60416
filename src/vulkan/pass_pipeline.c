// Creates the parts of compute passes: layouts, specialised pipelines, descriptor pools and descriptor sets.
#include "vulkan/vulkan_frame.h"

enum { MAX_BINDINGS = 16 };

static const char WHAT[] = "a frame's passes";

static VkDescriptorType binding_type(uint32_t binding, uint32_t first_storage) {
  return binding < first_storage ? VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER : VK_DESCRIPTOR_TYPE_STORAGE_IMAGE;
}

olx_result olx_gpu_set_layout_create(const olx_vulkan_context *c, uint32_t count, uint32_t first_storage,
                                     VkDescriptorSetLayout *layout) {
  const uint32_t all = (1u << count) - 1, sampled = all & ((1u << first_storage) - 1);
  const olx_set_bindings bindings = {
      .sampled = sampled, .stored = all & ~sampled, .stages = VK_SHADER_STAGE_COMPUTE_BIT};
  return olx_vulkan_set_layout_create(c, &bindings, WHAT, layout);
}

olx_result olx_gpu_layout_create(const olx_vulkan_context *c, uint32_t set_count, const VkDescriptorSetLayout *sets,
                                 uint32_t constant_bytes, VkPipelineLayout *layout) {
  const VkPushConstantRange range = {VK_SHADER_STAGE_COMPUTE_BIT, 0, constant_bytes};
  const VkPipelineLayoutCreateInfo info = {.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
                                           .setLayoutCount = set_count,
                                           .pSetLayouts = sets,
                                           .pushConstantRangeCount = 1,
                                           .pPushConstantRanges = &range};
  return olx_vulkan_check(c->vk.CreatePipelineLayout(c->host.device, &info, NULL, layout), "vkCreatePipelineLayout",
                          WHAT);
}

olx_result olx_gpu_pipeline_create(const olx_vulkan_context *c, const olx_pass_code *code,
                                   const olx_pass_constants *constants, VkPipelineLayout layout, VkPipeline *pipeline) {
  const VkShaderModuleCreateInfo module_info = {
      .sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO, .codeSize = code->bytes, .pCode = code->words};
  VkShaderModule module;
  OLX_TRY(olx_vulkan_check(c->vk.CreateShaderModule(c->host.device, &module_info, NULL, &module),
                           "vkCreateShaderModule", code->name));
  const uint32_t values[] = {constants ? (uint32_t)constants->tracer : 0, constants ? (uint32_t)constants->select : 0,
                             constants ? constants->hits : 0, constants ? constants->geometry : 0};
  const VkSpecializationMapEntry entries[] = {{OLX_CONSTANT_TRACER, 0, sizeof values[0]},
                                              {OLX_CONSTANT_SELECT, sizeof values[0], sizeof values[0]},
                                              {OLX_CONSTANT_HITS, 2 * sizeof values[0], sizeof values[0]},
                                              {OLX_CONSTANT_GEOMETRY, 3 * sizeof values[0], sizeof values[0]}};
  const VkSpecializationInfo special = {
      .mapEntryCount = 4, .pMapEntries = entries, .dataSize = sizeof values, .pData = values};
  const VkComputePipelineCreateInfo info = {
      .sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO,
      .stage = {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
                .stage = VK_SHADER_STAGE_COMPUTE_BIT,
                .module = module,
                .pName = "main",
                .pSpecializationInfo = constants ? &special : NULL},
      .layout = layout,
  };
  const VkResult result =
      c->vk.CreateComputePipelines(c->host.device, c->host.pipeline_cache, 1, &info, NULL, pipeline);
  c->vk.DestroyShaderModule(c->host.device, module, NULL);
  return olx_vulkan_check(result, "vkCreateComputePipelines", code->name);
}

olx_result olx_gpu_pool_create(const olx_vulkan_context *c, uint32_t sets, uint32_t sampled, uint32_t stored,
                               VkDescriptorPool *pool) {
  const VkDescriptorPoolSize sizes[] = {{VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, sampled},
                                        {VK_DESCRIPTOR_TYPE_STORAGE_IMAGE, stored}};
  const VkDescriptorPoolCreateInfo info = {.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
                                           .maxSets = sets,
                                           .poolSizeCount = sizeof sizes / sizeof sizes[0],
                                           .pPoolSizes = sizes};
  return olx_vulkan_check(c->vk.CreateDescriptorPool(c->host.device, &info, NULL, pool), "vkCreateDescriptorPool",
                          WHAT);
}

olx_result olx_gpu_set_allocate(const olx_vulkan_context *c, VkDescriptorPool pool, VkDescriptorSetLayout layout,
                                VkDescriptorSet *set) {
  const VkDescriptorSetAllocateInfo info = {.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
                                            .descriptorPool = pool,
                                            .descriptorSetCount = 1,
                                            .pSetLayouts = &layout};
  return olx_vulkan_check(c->vk.AllocateDescriptorSets(c->host.device, &info, set), "vkAllocateDescriptorSets", WHAT);
}

void olx_gpu_set_write(const olx_vulkan_context *c, VkDescriptorSet set, uint32_t bindings, uint32_t first_storage,
                       const VkDescriptorImageInfo *images) {
  VkWriteDescriptorSet writes[MAX_BINDINGS];
  for (uint32_t i = 0; i < bindings; i++) {
    writes[i] = (VkWriteDescriptorSet){.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                                       .dstSet = set,
                                       .dstBinding = i,
                                       .descriptorCount = 1,
                                       .descriptorType = binding_type(i, first_storage),
                                       .pImageInfo = &images[i]};
  }
  c->vk.UpdateDescriptorSets(c->host.device, bindings, writes, 0, NULL);
}
