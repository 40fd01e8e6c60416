// Draws the box in one pass into the images that Octalux reads: depth, normal, albedo and material, with emission and
// direct light in the colour image.
#include "surface_pass.h"

#include "box_geometry.h"

static const uint32_t VERTEX_SHADER[] =
#include "surface.vert.spv.inc"
    ;
static const uint32_t FRAGMENT_SHADER[] =
#include "surface.frag.spv.inc"
    ;
static const uint32_t OWN_DIFFUSE_SHADER[] = // surface.frag with OWN_DIFFUSE
#include "surface_own_diffuse.frag.spv.inc"
    ;

static const VkShaderStageFlags CAMERA_STAGES = VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT;

enum { COLORS = SURFACE_DEPTH, ATTRIBUTES = sizeof(box_vertex) / sizeof(olx_vec3) };

static const VkFormat FORMATS[SURFACE_IMAGES] = {
    [SURFACE_NORMAL] = VK_FORMAT_R16G16B16A16_SFLOAT, [SURFACE_ALBEDO] = VK_FORMAT_R8G8B8A8_SRGB,
    [SURFACE_MATERIAL] = VK_FORMAT_R8G8B8A8_UNORM,    [SURFACE_COLOR] = VK_FORMAT_R16G16B16A16_SFLOAT,
    [SURFACE_DEPTH] = VK_FORMAT_D32_SFLOAT,
};

VkImageLayout surface_layout(uint32_t image) {
  return image == SURFACE_COLOR   ? VK_IMAGE_LAYOUT_GENERAL
         : image == SURFACE_DEPTH ? VK_IMAGE_LAYOUT_DEPTH_STENCIL_READ_ONLY_OPTIMAL
                                  : VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL;
}

static void make_images(const gpu *g, surface_pass *pass) {
  for (uint32_t i = 0; i < SURFACE_IMAGES; i++) {
    // Octalux samples the G-buffer and writes the picture as a storage image.
    const VkImageUsageFlags drawn =
        i == SURFACE_DEPTH ? VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT : VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT;
    const VkImageUsageFlags used =
        i == SURFACE_COLOR ? VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT : VK_IMAGE_USAGE_SAMPLED_BIT;
    pass->images[i] = gpu_make_image(g, pass->size, FORMATS[i], drawn | used);
  }
}

static void make_render_pass(const gpu *g, surface_pass *pass) {
  VkAttachmentDescription attachments[SURFACE_IMAGES];
  VkAttachmentReference colors[COLORS];
  VkImageView views[SURFACE_IMAGES];
  for (uint32_t i = 0; i < SURFACE_IMAGES; i++) {
    attachments[i] = (VkAttachmentDescription){.format = FORMATS[i],
                                               .samples = VK_SAMPLE_COUNT_1_BIT,
                                               .loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR,
                                               .storeOp = VK_ATTACHMENT_STORE_OP_STORE,
                                               .stencilLoadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE,
                                               .stencilStoreOp = VK_ATTACHMENT_STORE_OP_DONT_CARE,
                                               .initialLayout = VK_IMAGE_LAYOUT_UNDEFINED,
                                               .finalLayout = surface_layout(i)};
    if (i < COLORS) colors[i] = (VkAttachmentReference){i, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL};
    views[i] = pass->images[i].view;
  }
  const VkAttachmentReference depth = {SURFACE_DEPTH, VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL};
  const VkSubpassDescription subpass = {.pipelineBindPoint = VK_PIPELINE_BIND_POINT_GRAPHICS,
                                        .colorAttachmentCount = COLORS,
                                        .pColorAttachments = colors,
                                        .pDepthStencilAttachment = &depth};
  // The dependencies order this pass after the compute shaders of the previous frame, and before those of this frame,
  // which Octalux's passes are.
  const VkPipelineStageFlags tests =
      VK_PIPELINE_STAGE_EARLY_FRAGMENT_TESTS_BIT | VK_PIPELINE_STAGE_LATE_FRAGMENT_TESTS_BIT;
  const VkAccessFlags writes = VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT | VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT;
  const VkSubpassDependency dependencies[2] = {
      {.srcSubpass = VK_SUBPASS_EXTERNAL,
       .dstSubpass = 0,
       .srcStageMask = VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT,
       .dstStageMask = VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT | tests,
       .dstAccessMask = writes | VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_READ_BIT},
      {.srcSubpass = 0,
       .dstSubpass = VK_SUBPASS_EXTERNAL,
       .srcStageMask = VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT | tests,
       .dstStageMask = VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT,
       .srcAccessMask = writes,
       .dstAccessMask = VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT}};
  const VkRenderPassCreateInfo info = {.sType = VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO,
                                       .attachmentCount = SURFACE_IMAGES,
                                       .pAttachments = attachments,
                                       .subpassCount = 1,
                                       .pSubpasses = &subpass,
                                       .dependencyCount = 2,
                                       .pDependencies = dependencies};
  gpu_need(vkCreateRenderPass(g->device, &info, NULL, &pass->render_pass), "a render pass");
  const VkFramebufferCreateInfo framebuffer = {.sType = VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO,
                                               .renderPass = pass->render_pass,
                                               .attachmentCount = SURFACE_IMAGES,
                                               .pAttachments = views,
                                               .width = pass->size.width,
                                               .height = pass->size.height,
                                               .layers = 1};
  gpu_need(vkCreateFramebuffer(g->device, &framebuffer, NULL, &pass->framebuffer), "a framebuffer");
}

static void make_scene(const gpu *g, surface_pass *pass) {
  box_vertex vertices[BOX_VERTICES];
  uint32_t indices[BOX_INDICES];
  box_geometry(vertices, indices);
  const VkBufferUsageFlags storage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT;
  pass->vertices = gpu_make_buffer(g, sizeof vertices, VK_BUFFER_USAGE_VERTEX_BUFFER_BIT | storage, vertices);
  pass->indices = gpu_make_buffer(g, sizeof indices, VK_BUFFER_USAGE_INDEX_BUFFER_BIT | storage, indices);

  const VkDescriptorType type = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
  const VkDescriptorSetLayoutBinding bindings[2] = {{0, type, 1, VK_SHADER_STAGE_FRAGMENT_BIT, NULL},
                                                    {1, type, 1, VK_SHADER_STAGE_FRAGMENT_BIT, NULL}};
  const VkDescriptorSetLayoutCreateInfo layout = {
      .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO, .bindingCount = 2, .pBindings = bindings};
  gpu_need(vkCreateDescriptorSetLayout(g->device, &layout, NULL, &pass->set_layout), "a set layout");
  const VkDescriptorPoolSize size = {type, 2};
  const VkDescriptorPoolCreateInfo pool = {
      .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO, .maxSets = 1, .poolSizeCount = 1, .pPoolSizes = &size};
  gpu_need(vkCreateDescriptorPool(g->device, &pool, NULL, &pass->pool), "a descriptor pool");
  const VkDescriptorSetAllocateInfo set = {.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
                                           .descriptorPool = pass->pool,
                                           .descriptorSetCount = 1,
                                           .pSetLayouts = &pass->set_layout};
  gpu_need(vkAllocateDescriptorSets(g->device, &set, &pass->set), "a descriptor set");
  const VkDescriptorBufferInfo buffers[2] = {{pass->vertices.buffer, 0, VK_WHOLE_SIZE},
                                             {pass->indices.buffer, 0, VK_WHOLE_SIZE}};
  const VkWriteDescriptorSet write = {.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                                      .dstSet = pass->set,
                                      .descriptorCount = 2, // for bindings 0 and 1
                                      .descriptorType = type,
                                      .pBufferInfo = buffers};
  vkUpdateDescriptorSets(g->device, 1, &write, 0, NULL);
}

static void make_layout(const gpu *g, surface_pass *pass, VkDescriptorSetLayout field_set) {
  const VkDescriptorSetLayout sets[2] = {pass->set_layout, field_set}; // surface.frag defines OLX_FIELD_SET as 1
  const VkPushConstantRange camera = {CAMERA_STAGES, 0, sizeof(surface_camera)};
  const VkPipelineLayoutCreateInfo layout = {.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
                                             .setLayoutCount = 2,
                                             .pSetLayouts = sets,
                                             .pushConstantRangeCount = 1,
                                             .pPushConstantRanges = &camera};
  gpu_need(vkCreatePipelineLayout(g->device, &layout, NULL, &pass->layout), "a pipeline layout");
}

static VkPipelineShaderStageCreateInfo stage(VkShaderStageFlagBits which, VkShaderModule shader) {
  return (VkPipelineShaderStageCreateInfo){
      .sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO, .stage = which, .module = shader, .pName = "main"};
}

static void make_pipeline(const gpu *g, surface_pass *pass, VkShaderModule vertex, VkShaderModule fragment) {
  const VkPipelineShaderStageCreateInfo stages[2] = {stage(VK_SHADER_STAGE_VERTEX_BIT, vertex),
                                                     stage(VK_SHADER_STAGE_FRAGMENT_BIT, fragment)};
  const VkVertexInputBindingDescription binding = {0, sizeof(box_vertex), VK_VERTEX_INPUT_RATE_VERTEX};
  VkVertexInputAttributeDescription attributes[ATTRIBUTES];
  for (uint32_t i = 0; i < ATTRIBUTES; i++) {
    attributes[i] =
        (VkVertexInputAttributeDescription){i, 0, VK_FORMAT_R32G32B32_SFLOAT, i * (uint32_t)sizeof(olx_vec3)};
  }
  const VkPipelineVertexInputStateCreateInfo input = {.sType =
                                                          VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO,
                                                      .vertexBindingDescriptionCount = 1,
                                                      .pVertexBindingDescriptions = &binding,
                                                      .vertexAttributeDescriptionCount = ATTRIBUTES,
                                                      .pVertexAttributeDescriptions = attributes};
  const VkPipelineInputAssemblyStateCreateInfo assembly = {
      .sType = VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO,
      .topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST};
  const VkViewport viewport = {0, 0, (float)pass->size.width, (float)pass->size.height, 0, 1};
  const VkRect2D scissor = {{0, 0}, pass->size};
  const VkPipelineViewportStateCreateInfo view = {.sType = VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO,
                                                  .viewportCount = 1,
                                                  .pViewports = &viewport,
                                                  .scissorCount = 1,
                                                  .pScissors = &scissor};
  const VkPipelineRasterizationStateCreateInfo raster = {.sType =
                                                             VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO,
                                                         .cullMode = VK_CULL_MODE_NONE,
                                                         .lineWidth = 1.0f};
  const VkPipelineMultisampleStateCreateInfo samples = {
      .sType = VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO, .rasterizationSamples = VK_SAMPLE_COUNT_1_BIT};
  const VkPipelineDepthStencilStateCreateInfo depth = {.sType =
                                                           VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO,
                                                       .depthTestEnable = VK_TRUE,
                                                       .depthWriteEnable = VK_TRUE,
                                                       .depthCompareOp = VK_COMPARE_OP_GREATER};
  VkPipelineColorBlendAttachmentState writes[COLORS];
  for (uint32_t i = 0; i < COLORS; i++) writes[i] = (VkPipelineColorBlendAttachmentState){.colorWriteMask = 0xF};
  const VkPipelineColorBlendStateCreateInfo blend = {.sType = VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO,
                                                     .attachmentCount = COLORS,
                                                     .pAttachments = writes};
  const VkGraphicsPipelineCreateInfo info = {.sType = VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO,
                                             .stageCount = 2,
                                             .pStages = stages,
                                             .pVertexInputState = &input,
                                             .pInputAssemblyState = &assembly,
                                             .pViewportState = &view,
                                             .pRasterizationState = &raster,
                                             .pMultisampleState = &samples,
                                             .pDepthStencilState = &depth,
                                             .pColorBlendState = &blend,
                                             .layout = pass->layout,
                                             .renderPass = pass->render_pass};
  gpu_need(vkCreateGraphicsPipelines(g->device, VK_NULL_HANDLE, 1, &info, NULL, &pass->pipeline), "a pipeline");
}

surface_pass surface_pass_make(const gpu *g, VkExtent2D size, VkDescriptorSetLayout field_set, bool own_diffuse) {
  surface_pass pass = {.size = size};
  make_scene(g, &pass);
  make_images(g, &pass);
  make_render_pass(g, &pass);
  make_layout(g, &pass, field_set);
  const VkShaderModule vertex = gpu_make_shader(g, VERTEX_SHADER, sizeof VERTEX_SHADER);
  const VkShaderModule fragment = own_diffuse ? gpu_make_shader(g, OWN_DIFFUSE_SHADER, sizeof OWN_DIFFUSE_SHADER)
                                              : gpu_make_shader(g, FRAGMENT_SHADER, sizeof FRAGMENT_SHADER);
  make_pipeline(g, &pass, vertex, fragment);
  vkDestroyShaderModule(g->device, vertex, NULL);
  vkDestroyShaderModule(g->device, fragment, NULL);
  return pass;
}

void surface_pass_free(const gpu *g, surface_pass *pass) {
  vkDestroyPipeline(g->device, pass->pipeline, NULL);
  vkDestroyPipelineLayout(g->device, pass->layout, NULL);
  vkDestroyDescriptorPool(g->device, pass->pool, NULL);
  vkDestroyDescriptorSetLayout(g->device, pass->set_layout, NULL);
  vkDestroyFramebuffer(g->device, pass->framebuffer, NULL);
  vkDestroyRenderPass(g->device, pass->render_pass, NULL);
  for (uint32_t i = 0; i < SURFACE_IMAGES; i++) gpu_free_image(g, &pass->images[i]);
  gpu_free_buffer(g, &pass->vertices);
  gpu_free_buffer(g, &pass->indices);
}

void surface_pass_record(const gpu *g, const surface_pass *pass, const surface_camera *camera,
                         VkDescriptorSet field_set) {
  const VkClearValue clear[SURFACE_IMAGES] = {0}; // depth 0 means no surface
  const VkDeviceSize offset = 0;
  const VkDescriptorSet sets[2] = {pass->set, field_set};
  const VkRenderPassBeginInfo begin = {.sType = VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO,
                                       .renderPass = pass->render_pass,
                                       .framebuffer = pass->framebuffer,
                                       .renderArea = {{0, 0}, pass->size},
                                       .clearValueCount = SURFACE_IMAGES,
                                       .pClearValues = clear};
  vkCmdBeginRenderPass(g->commands, &begin, VK_SUBPASS_CONTENTS_INLINE);
  vkCmdBindPipeline(g->commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pass->pipeline);
  vkCmdBindDescriptorSets(g->commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pass->layout, 0, 2, sets, 0, NULL);
  vkCmdPushConstants(g->commands, pass->layout, CAMERA_STAGES, 0, sizeof *camera, camera);
  vkCmdBindVertexBuffers(g->commands, 0, 1, &pass->vertices.buffer, &offset);
  vkCmdBindIndexBuffer(g->commands, pass->indices.buffer, 0, VK_INDEX_TYPE_UINT32);
  vkCmdDrawIndexed(g->commands, BOX_INDICES, 1, 0, 0, 0);
  vkCmdEndRenderPass(g->commands);
}
