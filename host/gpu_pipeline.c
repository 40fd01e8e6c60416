// Creates descriptor sets, and graphics and compute pipelines from embedded SPIR-V.
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

bool gpu_layout_create(gpu_device *d, const char *what, const VkDescriptorSetLayout *sets, uint32_t set_count,
                       VkShaderStageFlags stages, uint32_t push_bytes, VkPipelineLayout *layout) {
  const VkPushConstantRange push = {stages, 0, push_bytes};
  const VkPipelineLayoutCreateInfo info = {.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
                                           .setLayoutCount = set_count,
                                           .pSetLayouts = sets,
                                           .pushConstantRangeCount = 1,
                                           .pPushConstantRanges = &push};
  return gpu_check(d, d->CreatePipelineLayout(d->host.device, &info, NULL, layout), what);
}

// Creates a shader stage. The caller destroys the module, which may be null.
static bool create_stage(gpu_device *d, const char *what, gpu_code code, VkShaderStageFlagBits stage,
                         VkPipelineShaderStageCreateInfo *info) {
  *info = (VkPipelineShaderStageCreateInfo){
      .sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO, .stage = stage, .pName = "main"};
  if (!code.words) return true;
  const VkShaderModuleCreateInfo module = {
      .sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO, .codeSize = code.bytes, .pCode = code.words};
  return gpu_check(d, d->CreateShaderModule(d->host.device, &module, NULL, &info->module), what);
}

static void destroy_stages(gpu_device *d, const VkPipelineShaderStageCreateInfo *stages, uint32_t count) {
  for (uint32_t i = 0; i < count; i++) {
    if (stages[i].module) d->DestroyShaderModule(d->host.device, stages[i].module, NULL);
  }
}

// ---- Graphics pipelines

static VkResult create_graphics(gpu_device *d, const gpu_graphics_info *info,
                                const VkPipelineShaderStageCreateInfo stages[2], VkPipeline *pipeline) {
  const VkPipelineVertexInputStateCreateInfo input = {.sType =
                                                          VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO};
  const VkPipelineInputAssemblyStateCreateInfo assembly = {
      .sType = VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO,
      .topology = info->strip ? VK_PRIMITIVE_TOPOLOGY_TRIANGLE_STRIP : VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST};
  const VkPipelineViewportStateCreateInfo viewport = {
      .sType = VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO, .viewportCount = 1, .scissorCount = 1};
  const VkPipelineRasterizationStateCreateInfo raster = {.sType =
                                                             VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO,
                                                         .polygonMode = VK_POLYGON_MODE_FILL,
                                                         .cullMode = VK_CULL_MODE_NONE,
                                                         .depthBiasEnable = info->slope_bias != 0.0f,
                                                         .depthBiasConstantFactor = info->slope_bias,
                                                         .depthBiasSlopeFactor = info->slope_bias,
                                                         .lineWidth = 1.0f};
  const VkPipelineMultisampleStateCreateInfo samples = {
      .sType = VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO, .rasterizationSamples = VK_SAMPLE_COUNT_1_BIT};
  const VkPipelineDepthStencilStateCreateInfo depth = {.sType =
                                                           VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO,
                                                       .depthTestEnable = VK_TRUE,
                                                       .depthWriteEnable = VK_TRUE,
                                                       .depthCompareOp = info->depth};
  const VkPipelineColorBlendAttachmentState one = {.blendEnable = info->blended,
                                                   .srcColorBlendFactor = VK_BLEND_FACTOR_SRC_ALPHA,
                                                   .dstColorBlendFactor = VK_BLEND_FACTOR_ONE_MINUS_SRC_ALPHA,
                                                   .srcAlphaBlendFactor = VK_BLEND_FACTOR_ZERO,
                                                   .dstAlphaBlendFactor = VK_BLEND_FACTOR_ONE,
                                                   .colorWriteMask = 0xF};
  const VkPipelineColorBlendAttachmentState attachments[GPU_MOST_COLORS] = {one, one, one, one, one};
  const VkPipelineColorBlendStateCreateInfo blend = {.sType = VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO,
                                                     .attachmentCount = info->colors,
                                                     .pAttachments = attachments};
  const VkDynamicState dynamic[2] = {VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR};
  const VkPipelineDynamicStateCreateInfo dynamics = {
      .sType = VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO, .dynamicStateCount = 2, .pDynamicStates = dynamic};
  const VkGraphicsPipelineCreateInfo create = {.sType = VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO,
                                               .stageCount = stages[1].module ? 2 : 1,
                                               .pStages = stages,
                                               .pVertexInputState = &input,
                                               .pInputAssemblyState = &assembly,
                                               .pViewportState = &viewport,
                                               .pRasterizationState = &raster,
                                               .pMultisampleState = &samples,
                                               .pDepthStencilState = &depth,
                                               .pColorBlendState = &blend,
                                               .pDynamicState = &dynamics,
                                               .layout = info->layout,
                                               .renderPass = info->render_pass};
  return d->CreateGraphicsPipelines(d->host.device, VK_NULL_HANDLE, 1, &create, NULL, pipeline);
}

bool gpu_graphics_create(gpu_device *d, const gpu_graphics_info *info, VkPipeline *pipeline) {
  VkPipelineShaderStageCreateInfo stages[2] = {{.module = VK_NULL_HANDLE}, {.module = VK_NULL_HANDLE}};
  const bool fine = create_stage(d, info->what, info->vertex, VK_SHADER_STAGE_VERTEX_BIT, &stages[0]) &&
                    create_stage(d, info->what, info->fragment, VK_SHADER_STAGE_FRAGMENT_BIT, &stages[1]) &&
                    gpu_check(d, create_graphics(d, info, stages, pipeline), info->what);
  destroy_stages(d, stages, 2);
  return fine;
}

void gpu_viewport_record(const gpu_device *d, VkCommandBuffer commands, uint32_t width, uint32_t height) {
  const VkViewport viewport = {.width = (float)width, .height = (float)height, .maxDepth = 1.0f};
  const VkRect2D scissor = {.extent = {width, height}};
  d->CmdSetViewport(commands, 0, 1, &viewport);
  d->CmdSetScissor(commands, 0, 1, &scissor);
}

// ---- Compute pipelines

bool gpu_compute_pipeline_create(gpu_device *d, const char *what, gpu_code code, VkPipelineLayout layout,
                                 VkPipeline *pipeline) {
  VkComputePipelineCreateInfo info = {.sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO, .layout = layout};
  const bool fine =
      create_stage(d, what, code, VK_SHADER_STAGE_COMPUTE_BIT, &info.stage) &&
      gpu_check(d, d->CreateComputePipelines(d->host.device, VK_NULL_HANDLE, 1, &info, NULL, pipeline), what);
  destroy_stages(d, &info.stage, 1);
  return fine;
}

bool gpu_compute_create(gpu_device *d, const char *what, gpu_code code, const VkDescriptorSetLayout *sets,
                        uint32_t set_count, uint32_t push_bytes, gpu_compute *compute) {
  *compute = (gpu_compute){.pipeline = VK_NULL_HANDLE};
  if (gpu_layout_create(d, what, sets, set_count, VK_SHADER_STAGE_COMPUTE_BIT, push_bytes, &compute->layout) &&
      gpu_compute_pipeline_create(d, what, code, compute->layout, &compute->pipeline)) {
    return true;
  }
  gpu_compute_destroy(d, compute);
  return false;
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
