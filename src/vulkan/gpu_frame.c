#include "vulkan/gpu_frame.h"

#include "core/hooks.h"

enum { MAX_SIZE = 16384, MAX_SAMPLES = 4096 };

static const char WHAT[] = "a frame's passes";

olx_vulkan_settings olx_vulkan_settings_default(void) {
  return (olx_vulkan_settings){.sample = olx_sample_settings_default(), .glossy_samples = 1};
}

// Formats that a surface's images may have; `unorm` tells those that hold 0 to 1 from those that hold signed numbers.
typedef struct input_format {
  VkFormat format;
  bool unorm;
} input_format;

static const input_format INPUT_FORMATS[] = {
    {VK_FORMAT_R8_UNORM, true},
    {VK_FORMAT_R8G8_UNORM, true},
    {VK_FORMAT_R8G8B8A8_UNORM, true},
    {VK_FORMAT_R8G8B8A8_SRGB, true},
    {VK_FORMAT_B8G8R8A8_UNORM, true},
    {VK_FORMAT_B8G8R8A8_SRGB, true},
    {VK_FORMAT_A8B8G8R8_UNORM_PACK32, true},
    {VK_FORMAT_A8B8G8R8_SRGB_PACK32, true},
    {VK_FORMAT_A2B10G10R10_UNORM_PACK32, true},
    {VK_FORMAT_A2R10G10B10_UNORM_PACK32, true},
    {VK_FORMAT_R16_UNORM, true},
    {VK_FORMAT_R16G16_UNORM, true},
    {VK_FORMAT_R16G16B16A16_UNORM, true},
    {VK_FORMAT_R8G8B8A8_SNORM, false},
    {VK_FORMAT_R16G16B16A16_SNORM, false},
    {VK_FORMAT_R16_SFLOAT, false},
    {VK_FORMAT_R16G16_SFLOAT, false},
    {VK_FORMAT_R16G16B16A16_SFLOAT, false},
    {VK_FORMAT_R32_SFLOAT, false},
    {VK_FORMAT_R32G32_SFLOAT, false},
    {VK_FORMAT_R32G32B32A32_SFLOAT, false},
    {VK_FORMAT_B10G11R11_UFLOAT_PACK32, false},
    {VK_FORMAT_D16_UNORM, true},
    {VK_FORMAT_X8_D24_UNORM_PACK32, true},
    {VK_FORMAT_D32_SFLOAT, false},
    {VK_FORMAT_D16_UNORM_S8_UINT, true},
    {VK_FORMAT_D24_UNORM_S8_UINT, true},
    {VK_FORMAT_D32_SFLOAT_S8_UINT, false},
};

static const input_format *find_format(VkFormat format) {
  for (size_t i = 0; i < sizeof INPUT_FORMATS / sizeof INPUT_FORMATS[0]; i++) {
    if (INPUT_FORMATS[i].format == format) return &INPUT_FORMATS[i];
  }
  return NULL;
}

static bool readable_layout(VkImageLayout layout) {
  switch (layout) {
  case VK_IMAGE_LAYOUT_GENERAL:
  case VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL:
  case VK_IMAGE_LAYOUT_DEPTH_STENCIL_READ_ONLY_OPTIMAL:
  case VK_IMAGE_LAYOUT_DEPTH_READ_ONLY_STENCIL_ATTACHMENT_OPTIMAL:
  case VK_IMAGE_LAYOUT_DEPTH_READ_ONLY_OPTIMAL: return true;
  default: return false;
  }
}

static olx_result check_input(const olx_vulkan_context *c, const olx_vulkan_image *image, const char *name) {
  if (!image->view) return olx_fail(OLX_ERROR_ARGUMENT, "the frame has no %s image", name);
  if (!find_format(image->format)) {
    return olx_fail(OLX_ERROR_ARGUMENT, "the %s image's VkFormat %d is not one that passes read", name,
                    (int)image->format);
  }
  if (!readable_layout(image->layout)) {
    return olx_fail(OLX_ERROR_ARGUMENT, "the %s image cannot be sampled in VkImageLayout %d", name, (int)image->layout);
  }
  VkFormatProperties properties;
  c->vk.GetPhysicalDeviceFormatProperties(c->host.physical_device, image->format, &properties);
  if (!(properties.optimalTilingFeatures & VK_FORMAT_FEATURE_SAMPLED_IMAGE_BIT)) {
    return olx_fail(OLX_ERROR_UNSUPPORTED, "the device cannot sample the %s image's VkFormat %d", name,
                    (int)image->format);
  }
  return OLX_OK;
}

static olx_result check_targets(const olx_vulkan_context *c, const olx_vulkan_targets *t) {
  if (t->width < 1 || t->width > MAX_SIZE || t->height < 1 || t->height > MAX_SIZE) {
    return olx_fail(OLX_ERROR_ARGUMENT, "frame size %u x %u is not within 1 to %d", t->width, t->height, MAX_SIZE);
  }
  OLX_TRY(check_input(c, &t->depth, "depth"));
  OLX_TRY(check_input(c, &t->normal, "normal"));
  OLX_TRY(check_input(c, &t->albedo, "albedo"));
  OLX_TRY(check_input(c, &t->roughness, "roughness"));
  if (!t->irradiance || !t->glossy || !t->color) {
    return olx_fail(OLX_ERROR_ARGUMENT, "the frame has no %s image",
                    !t->irradiance ? "irradiance"
                    : !t->glossy   ? "glossy"
                                   : "color");
  }
  return OLX_OK;
}

static VkDescriptorType binding_type(uint32_t binding) {
  return binding < OLX_BINDING_OUT_IRRADIANCE ? VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER
                                              : VK_DESCRIPTOR_TYPE_STORAGE_IMAGE;
}

static olx_result create_layouts(olx_vulkan_frame *f) {
  const olx_vulkan_context *c = &f->field->context;
  VkDescriptorSetLayoutBinding bindings[OLX_FRAME_BINDINGS];
  for (uint32_t i = 0; i < OLX_FRAME_BINDINGS; i++) {
    bindings[i] = (VkDescriptorSetLayoutBinding){.binding = i,
                                                 .descriptorType = binding_type(i),
                                                 .descriptorCount = 1,
                                                 .stageFlags = VK_SHADER_STAGE_COMPUTE_BIT};
  }
  const VkDescriptorSetLayoutCreateInfo set = {.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
                                               .bindingCount = OLX_FRAME_BINDINGS,
                                               .pBindings = bindings};
  OLX_TRY(olx_vulkan_check(c->vk.CreateDescriptorSetLayout(c->host.device, &set, NULL, &f->set_layout),
                           "vkCreateDescriptorSetLayout", WHAT));
  const VkDescriptorSetLayout sets[] = {f->field->set_layout, f->set_layout};
  const VkPushConstantRange range = {VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof(olx_gpu_frame)};
  const VkPipelineLayoutCreateInfo layout = {.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
                                             .setLayoutCount = 2,
                                             .pSetLayouts = sets,
                                             .pushConstantRangeCount = 1,
                                             .pPushConstantRanges = &range};
  return olx_vulkan_check(c->vk.CreatePipelineLayout(c->host.device, &layout, NULL, &f->layout),
                          "vkCreatePipelineLayout", WHAT);
}

static olx_result create_pipeline(olx_vulkan_frame *f, const olx_pass_code *code, VkPipeline *pipeline) {
  const olx_vulkan_context *c = &f->field->context;
  const VkShaderModuleCreateInfo module_info = {
      .sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO, .codeSize = code->bytes, .pCode = code->words};
  VkShaderModule module;
  OLX_TRY(olx_vulkan_check(c->vk.CreateShaderModule(c->host.device, &module_info, NULL, &module),
                           "vkCreateShaderModule", code->name));
  const VkComputePipelineCreateInfo info = {
      .sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO,
      .stage = {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
                .stage = VK_SHADER_STAGE_COMPUTE_BIT,
                .module = module,
                .pName = "main"},
      .layout = f->layout,
  };
  const VkResult result = c->vk.CreateComputePipelines(c->host.device, VK_NULL_HANDLE, 1, &info, NULL, pipeline);
  c->vk.DestroyShaderModule(c->host.device, module, NULL);
  return olx_vulkan_check(result, "vkCreateComputePipelines", code->name);
}

static olx_result create_pool(olx_vulkan_frame *f) {
  const olx_vulkan_context *c = &f->field->context;
  const VkDescriptorPoolSize sizes[] = {
      {VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, OLX_BINDING_OUT_IRRADIANCE},
      {VK_DESCRIPTOR_TYPE_STORAGE_IMAGE, OLX_FRAME_BINDINGS - OLX_BINDING_OUT_IRRADIANCE},
  };
  const VkDescriptorPoolCreateInfo info = {.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
                                           .maxSets = 1,
                                           .poolSizeCount = sizeof sizes / sizeof sizes[0],
                                           .pPoolSizes = sizes};
  OLX_TRY(olx_vulkan_check(c->vk.CreateDescriptorPool(c->host.device, &info, NULL, &f->pool), "vkCreateDescriptorPool",
                           WHAT));
  const VkDescriptorSetAllocateInfo set = {.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
                                           .descriptorPool = f->pool,
                                           .descriptorSetCount = 1,
                                           .pSetLayouts = &f->set_layout};
  return olx_vulkan_check(c->vk.AllocateDescriptorSets(c->host.device, &set, &f->set), "vkAllocateDescriptorSets",
                          WHAT);
}

olx_result olx_vulkan_frame_resize(olx_vulkan_frame *f, const olx_vulkan_targets *t) {
  const olx_vulkan_context *c = &f->field->context;
  OLX_TRY(check_targets(c, t));
  const olx_vulkan_image inputs[] = {t->depth, t->normal, t->albedo, t->roughness};
  const VkImageView outputs[] = {t->irradiance, t->glossy, t->color};
  VkDescriptorImageInfo images[OLX_FRAME_BINDINGS];
  VkWriteDescriptorSet writes[OLX_FRAME_BINDINGS];
  for (uint32_t i = 0; i < OLX_FRAME_BINDINGS; i++) {
    images[i] =
        i < OLX_BINDING_OUT_IRRADIANCE
            ? (VkDescriptorImageInfo){f->field->nearest, inputs[i].view, inputs[i].layout}
            : (VkDescriptorImageInfo){VK_NULL_HANDLE, outputs[i - OLX_BINDING_OUT_IRRADIANCE], VK_IMAGE_LAYOUT_GENERAL};
    writes[i] = (VkWriteDescriptorSet){.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                                       .dstSet = f->set,
                                       .dstBinding = i,
                                       .descriptorCount = 1,
                                       .descriptorType = binding_type(i),
                                       .pImageInfo = &images[i]};
  }
  c->vk.UpdateDescriptorSets(c->host.device, OLX_FRAME_BINDINGS, writes, 0, NULL);
  f->width = t->width;
  f->height = t->height;
  f->normal_unorm = find_format(t->normal.format)->unorm;
  return OLX_OK;
}

static olx_result create_frame(olx_vulkan_frame *f, const olx_vulkan_targets *targets) {
  const olx_pass_code *codes[OLX_PASS_COUNT] = {&olx_irradiance_pass, &olx_trace_pass, &olx_composite_pass};
  OLX_TRY(check_targets(&f->field->context, targets));
  OLX_TRY(create_layouts(f));
  for (uint32_t i = 0; i < OLX_PASS_COUNT; i++) OLX_TRY(create_pipeline(f, codes[i], &f->pipelines[i]));
  OLX_TRY(create_pool(f));
  return olx_vulkan_frame_resize(f, targets);
}

olx_result olx_vulkan_frame_create(olx_vulkan_field *field, const olx_vulkan_targets *targets,
                                   olx_vulkan_frame **frame) {
  *frame = NULL;
  olx_vulkan_frame *f = olx_allocate_zero(1, sizeof *f);
  if (!f) return olx_fail(OLX_ERROR_MEMORY, "%s: no memory for their handle", WHAT);
  f->field = field;
  const olx_result result = create_frame(f, targets);
  if (result != OLX_OK) {
    olx_vulkan_frame_destroy(f);
    return result;
  }
  *frame = f;
  return OLX_OK;
}

void olx_vulkan_frame_destroy(olx_vulkan_frame *f) {
  if (!f) return;
  const olx_vulkan_functions *vk = &f->field->context.vk;
  const VkDevice device = f->field->context.host.device;
  vk->DestroyDescriptorPool(device, f->pool, NULL);
  for (uint32_t i = 0; i < OLX_PASS_COUNT; i++) vk->DestroyPipeline(device, f->pipelines[i], NULL);
  vk->DestroyPipelineLayout(device, f->layout, NULL);
  vk->DestroyDescriptorSetLayout(device, f->set_layout, NULL);
  olx_release(f);
}

static olx_result check_settings(const olx_vulkan_settings *s) {
  if ((uint32_t)s->sample.tracer > OLX_TRACER_HIZ) {
    return olx_fail(OLX_ERROR_UNSUPPORTED, "tracer %d does not run on the GPU", (int)s->sample.tracer);
  }
  if (s->sample.select < OLX_SELECT_EXHAUSTIVE && !(OLX_SELECT_GPU_MASK >> s->sample.select & 1u)) {
    return olx_fail(OLX_ERROR_UNSUPPORTED, "the selector '%s' does not run on the GPU",
                    olx_select_name(s->sample.select));
  }
  if (s->glossy_samples < 1 || s->glossy_samples > MAX_SAMPLES) {
    return olx_fail(OLX_ERROR_ARGUMENT, "%u glossy rays are not within 1 to %d", s->glossy_samples, MAX_SAMPLES);
  }
  return OLX_OK;
}

static olx_gpu_frame frame_constants(const olx_vulkan_frame *f, const olx_vulkan_view *view,
                                     const olx_vulkan_settings *s, uint32_t flags) {
  olx_gpu_frame constants = {
      .eye = {view->eye.x, view->eye.y, view->eye.z, view->empty_depth},
      .width = f->width,
      .height = f->height,
      .flags = flags | (s->sample.keep_buried ? OLX_FRAME_KEEP_BURIED : 0u) |
               (s->sample.emitters ? OLX_FRAME_EMITTERS : 0u) |
               (s->sample.visibility == OLX_VISIBILITY_CHEBYSHEV ? OLX_FRAME_VISIBILITY : 0u) |
               (f->normal_unorm ? OLX_FRAME_NORMAL_UNORM : 0u),
      .tracer = (uint32_t)s->sample.tracer,
      .select = (uint32_t)s->sample.select,
      .max_probes = s->sample.max_probes,
      .glossy_samples = s->glossy_samples,
      .sample_index = s->sample_index,
      .dim_lobe = s->dim_lobe,
      .seed = s->seed,
  };
  memcpy(constants.clip_to_world, view->clip_to_world, sizeof constants.clip_to_world);
  return constants;
}

olx_result olx_vulkan_record_pass(const olx_vulkan_frame *f, olx_pass pass, VkCommandBuffer commands,
                                  const olx_vulkan_view *view, const olx_vulkan_settings *settings, uint32_t flags) {
  OLX_TRY(check_settings(settings));
  const olx_vulkan_functions *vk = &f->field->context.vk;
  const olx_gpu_frame constants = frame_constants(f, view, settings, flags);
  const VkDescriptorSet sets[] = {f->field->set, f->set};
  vk->CmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, f->pipelines[pass]);
  vk->CmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, f->layout, 0, 2, sets, 0, NULL);
  vk->CmdPushConstants(commands, f->layout, VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof constants, &constants);
  vk->CmdDispatch(commands, (f->width + OLX_PASS_SIZE - 1) / OLX_PASS_SIZE,
                  (f->height + OLX_PASS_SIZE - 1) / OLX_PASS_SIZE, 1);
  return OLX_OK;
}
