#include "gpu_pipeline.h"

bool gpu_set_create(gpu_device *d, const char *what, const VkDescriptorType *types, uint32_t count,
                    VkShaderStageFlags stages, gpu_set *set) {
  VkDescriptorSetLayoutBinding bindings[GPU_MAX_BINDINGS];
  VkDescriptorPoolSize sizes[GPU_MAX_BINDINGS];
  *set = (gpu_set){.set = VK_NULL_HANDLE};
  for (uint32_t i = 0; i < count; i++) {
    bindings[i] = (VkDescriptorSetLayoutBinding){
        .binding = i, .descriptorType = types[i], .descriptorCount = 1, .stageFlags = stages};
    sizes[i] = (VkDescriptorPoolSize){types[i], 1};
  }
  const VkDescriptorSetLayoutCreateInfo layout = {
      .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO, .bindingCount = count, .pBindings = bindings};
  const VkDescriptorPoolCreateInfo pool = {.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
                                           .maxSets = 1,
                                           .poolSizeCount = count,
                                           .pPoolSizes = sizes};
  VkResult result = d->CreateDescriptorSetLayout(d->host.device, &layout, NULL, &set->layout);
  if (result == VK_SUCCESS) result = d->CreateDescriptorPool(d->host.device, &pool, NULL, &set->pool);
  if (result == VK_SUCCESS) {
    const VkDescriptorSetAllocateInfo info = {.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
                                              .descriptorPool = set->pool,
                                              .descriptorSetCount = 1,
                                              .pSetLayouts = &set->layout};
    result = d->AllocateDescriptorSets(d->host.device, &info, &set->set);
  }
  if (result == VK_SUCCESS) return true;
  gpu_set_destroy(d, set);
  return gpu_fail_result(d, result, what);
}

static bool is_buffer(VkDescriptorType type) {
  return type == VK_DESCRIPTOR_TYPE_STORAGE_BUFFER || type == VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER;
}

void gpu_set_write(const gpu_device *d, const gpu_set *set, const gpu_binding *bindings, uint32_t count) {
  VkDescriptorBufferInfo buffers[GPU_MAX_BINDINGS];
  VkDescriptorImageInfo images[GPU_MAX_BINDINGS];
  VkWriteDescriptorSet writes[GPU_MAX_BINDINGS];
  for (uint32_t i = 0; i < count; i++) {
    const gpu_binding *b = &bindings[i];
    if (is_buffer(b->type)) buffers[i] = (VkDescriptorBufferInfo){b->buffer->buffer, 0, VK_WHOLE_SIZE};
    else images[i] = (VkDescriptorImageInfo){b->sampler, b->view, b->layout};
    writes[i] = (VkWriteDescriptorSet){.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                                       .dstSet = set->set,
                                       .dstBinding = i,
                                       .descriptorCount = 1,
                                       .descriptorType = b->type,
                                       .pBufferInfo = &buffers[i],
                                       .pImageInfo = &images[i]};
  }
  d->UpdateDescriptorSets(d->host.device, count, writes, 0, NULL);
}

void gpu_set_destroy(gpu_device *d, gpu_set *set) {
  if (set->pool) d->DestroyDescriptorPool(d->host.device, set->pool, NULL);
  if (set->layout) d->DestroyDescriptorSetLayout(d->host.device, set->layout, NULL);
  *set = (gpu_set){.set = VK_NULL_HANDLE};
}

bool gpu_shader_create(gpu_device *d, const char *what, const uint32_t *words, size_t bytes, VkShaderModule *module) {
  const VkShaderModuleCreateInfo info = {
      .sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO, .codeSize = bytes, .pCode = words};
  return gpu_check(d, d->CreateShaderModule(d->host.device, &info, NULL, module), what);
}

bool gpu_compute_create(gpu_device *d, const char *what, const uint32_t *words, size_t bytes,
                        const VkDescriptorSetLayout *sets, uint32_t set_count, uint32_t push_bytes,
                        gpu_compute *compute) {
  *compute = (gpu_compute){.pipeline = VK_NULL_HANDLE};
  VkShaderModule module;
  if (!gpu_shader_create(d, what, words, bytes, &module)) return false;
  const VkPushConstantRange push = {VK_SHADER_STAGE_COMPUTE_BIT, 0, push_bytes};
  const VkPipelineLayoutCreateInfo layout = {.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
                                             .setLayoutCount = set_count,
                                             .pSetLayouts = sets,
                                             .pushConstantRangeCount = 1,
                                             .pPushConstantRanges = &push};
  VkResult result = d->CreatePipelineLayout(d->host.device, &layout, NULL, &compute->layout);
  if (result == VK_SUCCESS) {
    const VkComputePipelineCreateInfo info = {.sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO,
                                              .stage = {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
                                                        .stage = VK_SHADER_STAGE_COMPUTE_BIT,
                                                        .module = module,
                                                        .pName = "main"},
                                              .layout = compute->layout};
    result = d->CreateComputePipelines(d->host.device, VK_NULL_HANDLE, 1, &info, NULL, &compute->pipeline);
  }
  d->DestroyShaderModule(d->host.device, module, NULL);
  if (result == VK_SUCCESS) return true;
  gpu_compute_destroy(d, compute);
  return gpu_fail_result(d, result, what);
}

void gpu_compute_destroy(gpu_device *d, gpu_compute *compute) {
  if (compute->pipeline) d->DestroyPipeline(d->host.device, compute->pipeline, NULL);
  if (compute->layout) d->DestroyPipelineLayout(d->host.device, compute->layout, NULL);
  *compute = (gpu_compute){.pipeline = VK_NULL_HANDLE};
}

void gpu_compute_record(const gpu_device *d, const gpu_compute *compute, const VkDescriptorSet *sets,
                        uint32_t set_count, const void *push, uint32_t push_bytes, uint32_t width, uint32_t height,
                        VkCommandBuffer commands) {
  d->CmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, compute->pipeline);
  d->CmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, compute->layout, 0, set_count, sets, 0, NULL);
  d->CmdPushConstants(commands, compute->layout, VK_SHADER_STAGE_COMPUTE_BIT, 0, push_bytes, push);
  d->CmdDispatch(commands, (width + 7) / 8, (height + 7) / 8, 1);
}
