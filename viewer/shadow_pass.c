// Draws shadow maps, one layer for each view of each lamp.
#include "shadow_pass.h"

#include "gpu_pipeline.h"
#include "scene_draw.h"

#include <stdlib.h>
#include <string.h>

static const uint32_t VERTEX_SHADER[] = {
#include "occluder.spv.inc"
};
static const uint32_t MASK_SHADER[] = {
#include "occluder_mask.spv.inc"
};

static const float SLOPE_BIAS = -2.0f; // away from the lamp, because depth is reversed

static const VkPipelineStageFlags TESTS =
    VK_PIPELINE_STAGE_EARLY_FRAGMENT_TESTS_BIT | VK_PIPELINE_STAGE_LATE_FRAGMENT_TESTS_BIT;

static const VkImageLayout READ = VK_IMAGE_LAYOUT_DEPTH_STENCIL_READ_ONLY_OPTIMAL;

// Buffers and images must not be empty: without lamps they have one unused element.
static uint32_t at_least_one(uint32_t count) { return count ? count : 1; }

static bool upload_lamps(gpu_device *d, const lamp_list *list, shadow_pass *pass) {
  pass->lamp_count = list->lamp_count;
  pass->view_count = list->view_count;
  pass->left_out = list->left_out;
  pass->views = malloc(sizeof list->views);
  if (!pass->views) return gpu_fail(d, "out of memory for the lamps");
  memcpy(pass->views, list->views, sizeof list->views);
  const VkBufferUsageFlags usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT;
  return gpu_buffer_upload(d, "the lamps", list->lamps, at_least_one(list->lamp_count) * sizeof list->lamps[0], usage,
                           &pass->lamps) &&
         gpu_buffer_upload(d, "the lamps' views", list->views, at_least_one(list->view_count) * sizeof list->views[0],
                           usage, &pass->matrices);
}

static bool create_maps(gpu_device *d, shadow_pass *pass) {
  const uint32_t layers = at_least_one(pass->view_count);
  const gpu_image_info info = {.what = "the shadow maps",
                               .format = VK_FORMAT_D32_SFLOAT,
                               .width = pass->map_size,
                               .height = pass->map_size,
                               .layers = layers,
                               .usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT};
  if (!gpu_image_create(d, &info, &pass->maps) || !gpu_commands_begin(d)) return false;
  gpu_image_barrier(d, d->commands, &pass->maps, VK_IMAGE_LAYOUT_UNDEFINED, READ);
  return gpu_commands_run(d);
}

static bool create_render_pass(gpu_device *d, shadow_pass *pass) {
  const VkAttachmentDescription attachment = {.format = VK_FORMAT_D32_SFLOAT,
                                              .samples = VK_SAMPLE_COUNT_1_BIT,
                                              .loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR,
                                              .storeOp = VK_ATTACHMENT_STORE_OP_STORE,
                                              .stencilLoadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE,
                                              .stencilStoreOp = VK_ATTACHMENT_STORE_OP_DONT_CARE,
                                              .initialLayout = VK_IMAGE_LAYOUT_UNDEFINED,
                                              .finalLayout = READ};
  const VkAttachmentReference depth = {0, VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL};
  const VkSubpassDescription subpass = {.pipelineBindPoint = VK_PIPELINE_BIND_POINT_GRAPHICS,
                                        .pDepthStencilAttachment = &depth};
  const VkSubpassDependency dependencies[2] = {
      {.srcSubpass = VK_SUBPASS_EXTERNAL,
       .dstSubpass = 0,
       .srcStageMask = VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT | TESTS,
       .dstStageMask = TESTS,
       .srcAccessMask = VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT,
       .dstAccessMask = VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_READ_BIT | VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT},
      {.srcSubpass = 0,
       .dstSubpass = VK_SUBPASS_EXTERNAL,
       .srcStageMask = TESTS,
       .dstStageMask = VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT,
       .srcAccessMask = VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT,
       .dstAccessMask = VK_ACCESS_SHADER_READ_BIT}};
  const VkRenderPassCreateInfo info = {.sType = VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO,
                                       .attachmentCount = 1,
                                       .pAttachments = &attachment,
                                       .subpassCount = 1,
                                       .pSubpasses = &subpass,
                                       .dependencyCount = 2,
                                       .pDependencies = dependencies};
  return gpu_check(d, d->CreateRenderPass(d->host.device, &info, NULL, &pass->render_pass), "the shadows' pass");
}

static bool create_framebuffer(gpu_device *d, shadow_pass *pass, uint32_t layer) {
  const VkImageViewCreateInfo view = {.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
                                      .image = pass->maps.image,
                                      .viewType = VK_IMAGE_VIEW_TYPE_2D,
                                      .format = VK_FORMAT_D32_SFLOAT,
                                      .subresourceRange = {VK_IMAGE_ASPECT_DEPTH_BIT, 0, 1, layer, 1}};
  const VkResult made = d->CreateImageView(d->host.device, &view, NULL, &pass->layers[layer]);
  if (!gpu_check(d, made, "a shadow map's view")) return false;
  const VkFramebufferCreateInfo info = {.sType = VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO,
                                        .renderPass = pass->render_pass,
                                        .attachmentCount = 1,
                                        .pAttachments = &pass->layers[layer],
                                        .width = pass->map_size,
                                        .height = pass->map_size,
                                        .layers = 1};
  return gpu_check(d, d->CreateFramebuffer(d->host.device, &info, NULL, &pass->framebuffers[layer]),
                   "a shadow map's framebuffer");
}

static bool create_framebuffers(gpu_device *d, shadow_pass *pass) {
  pass->layers = calloc(at_least_one(pass->view_count), sizeof *pass->layers);
  pass->framebuffers = calloc(at_least_one(pass->view_count), sizeof *pass->framebuffers);
  if (!pass->layers || !pass->framebuffers) return gpu_fail(d, "out of memory for the shadow maps");
  bool fine = true;
  for (uint32_t i = 0; i < pass->view_count && fine; i++) fine = create_framebuffer(d, pass, i);
  return fine;
}

static bool create_pipelines(gpu_device *d, VkDescriptorSetLayout set_layout, shadow_pass *pass) {
  if (!scene_draw_layout(d, set_layout, &pass->layout)) return false;
  gpu_graphics_info info = {.what = "the shadows' pipelines",
                            .layout = pass->layout,
                            .render_pass = pass->render_pass,
                            .vertex = GPU_CODE(VERTEX_SHADER),
                            .depth = VK_COMPARE_OP_GREATER,
                            .slope_bias = SLOPE_BIAS};
  if (!gpu_graphics_create(d, &info, &pass->opaque)) return false;
  info.fragment = GPU_CODE(MASK_SHADER);
  return gpu_graphics_create(d, &info, &pass->masked);
}

bool shadow_pass_create(gpu_device *d, VkDescriptorSetLayout set_layout, const olx_scene_content *content,
                        const lamp_settings *settings, shadow_pass *pass) {
  *pass = (shadow_pass){.map_size = settings->map_size};
  lamp_list *list = calloc(1, sizeof *list);
  bool fine = (list && lamp_list_make(content, settings, list)) || gpu_fail(d, "out of memory for the lamps");
  fine = fine && upload_lamps(d, list, pass) && create_maps(d, pass) && create_render_pass(d, pass) &&
         create_framebuffers(d, pass) && create_pipelines(d, set_layout, pass);
  free(list);
  if (!fine) shadow_pass_destroy(d, pass);
  return fine;
}

bool shadow_pass_change(gpu_device *d, const lamp_list *list, shadow_pass *pass) {
  if (list->lamp_count != pass->lamp_count || list->view_count != pass->view_count)
    return gpu_fail(d, "lamps may move, but not come or go");
  memcpy(pass->views, list->views, sizeof list->views);
  return gpu_buffer_refill(d, "the lamps", list->lamps, &pass->lamps) &&
         gpu_buffer_refill(d, "the lamps' views", list->views, &pass->matrices);
}

void shadow_pass_destroy(gpu_device *d, shadow_pass *pass) {
  for (uint32_t i = 0; i < pass->view_count && pass->framebuffers; i++) {
    if (pass->framebuffers[i]) d->DestroyFramebuffer(d->host.device, pass->framebuffers[i], NULL);
  }
  for (uint32_t i = 0; i < pass->view_count && pass->layers; i++) {
    if (pass->layers[i]) d->DestroyImageView(d->host.device, pass->layers[i], NULL);
  }
  if (pass->opaque) d->DestroyPipeline(d->host.device, pass->opaque, NULL);
  if (pass->masked) d->DestroyPipeline(d->host.device, pass->masked, NULL);
  if (pass->layout) d->DestroyPipelineLayout(d->host.device, pass->layout, NULL);
  if (pass->render_pass) d->DestroyRenderPass(d->host.device, pass->render_pass, NULL);
  gpu_image_destroy(d, &pass->maps);
  gpu_buffer_destroy(d, &pass->lamps);
  gpu_buffer_destroy(d, &pass->matrices);
  free(pass->layers);
  free(pass->framebuffers);
  free(pass->views);
  *pass = (shadow_pass){.map_size = 0};
}

void shadow_pass_record(const gpu_device *d, const shadow_pass *pass, VkCommandBuffer commands, const draw_item *items,
                        uint32_t count) {
  const VkClearValue far = {.depthStencil = {.depth = 0.0f}};
  const olx_vec3 nowhere = {0};
  for (uint32_t i = 0; i < pass->view_count; i++) {
    const VkRenderPassBeginInfo begin = {.sType = VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO,
                                         .renderPass = pass->render_pass,
                                         .framebuffer = pass->framebuffers[i],
                                         .renderArea = {.extent = {pass->map_size, pass->map_size}},
                                         .clearValueCount = 1,
                                         .pClearValues = &far};
    const float *world_to_clip = pass->views[i].world_to_clip;
    d->CmdBeginRenderPass(commands, &begin, VK_SUBPASS_CONTENTS_INLINE);
    gpu_viewport_record(d, commands, pass->map_size, pass->map_size);
    d->CmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pass->opaque);
    scene_draw_record(d, commands, pass->layout, world_to_clip, nowhere, items, count, DRAW_OPAQUE);
    d->CmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pass->masked);
    scene_draw_record(d, commands, pass->layout, world_to_clip, nowhere, items, count, DRAW_MASKED);
    d->CmdEndRenderPass(commands);
  }
}
