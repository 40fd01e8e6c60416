// Draws scenes into the G-buffer: depth, normal, albedo, material and emission.
#include "gbuffer_pass.h"

#include "gpu_pipeline.h"
#include "scene_draw.h"

static const uint32_t VERTEX_SHADER[] = {
#include "geometry.spv.inc"
};
static const uint32_t FRAGMENT_SHADER[] = {
#include "gbuffer.spv.inc"
};

static const VkPipelineStageFlags TESTS =
    VK_PIPELINE_STAGE_EARLY_FRAGMENT_TESTS_BIT | VK_PIPELINE_STAGE_LATE_FRAGMENT_TESTS_BIT;

static VkImageLayout final_layout(uint32_t image) {
  return image == FRAME_COLOR   ? VK_IMAGE_LAYOUT_GENERAL
         : image == FRAME_DEPTH ? VK_IMAGE_LAYOUT_DEPTH_STENCIL_READ_ONLY_OPTIMAL
                                : VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL;
}

static bool create_render_pass(gpu_device *d, gbuffer_pass *pass) {
  VkAttachmentDescription attachments[FRAME_DRAWN];
  VkAttachmentReference colors[FRAME_COLORS];
  for (uint32_t i = 0; i < FRAME_DRAWN; i++) {
    attachments[i] = (VkAttachmentDescription){.format = frame_image_format((frame_image)i),
                                               .samples = VK_SAMPLE_COUNT_1_BIT,
                                               .loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR,
                                               .storeOp = VK_ATTACHMENT_STORE_OP_STORE,
                                               .stencilLoadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE,
                                               .stencilStoreOp = VK_ATTACHMENT_STORE_OP_DONT_CARE,
                                               .initialLayout = VK_IMAGE_LAYOUT_UNDEFINED,
                                               .finalLayout = final_layout(i)};
    if (i < FRAME_COLORS) colors[i] = (VkAttachmentReference){i, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL};
  }
  const VkAttachmentReference depth = {FRAME_DEPTH, VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL};
  const VkSubpassDescription subpass = {.pipelineBindPoint = VK_PIPELINE_BIND_POINT_GRAPHICS,
                                        .colorAttachmentCount = FRAME_COLORS,
                                        .pColorAttachments = colors,
                                        .pDepthStencilAttachment = &depth};
  const VkAccessFlags writes = VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT | VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT;
  const VkSubpassDependency dependencies[2] = {
      {.srcSubpass = VK_SUBPASS_EXTERNAL,
       .dstSubpass = 0,
       .srcStageMask = VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_TRANSFER_BIT |
                       VK_PIPELINE_STAGE_FRAGMENT_SHADER_BIT | VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT | TESTS,
       .dstStageMask = VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT | TESTS,
       .srcAccessMask = writes | VK_ACCESS_SHADER_WRITE_BIT,
       .dstAccessMask = writes | VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_READ_BIT},
      {.srcSubpass = 0,
       .dstSubpass = VK_SUBPASS_EXTERNAL,
       .srcStageMask = VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT | TESTS,
       .dstStageMask = VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_FRAGMENT_SHADER_BIT |
                       VK_PIPELINE_STAGE_TRANSFER_BIT | TESTS,
       .srcAccessMask = writes,
       .dstAccessMask = VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT | VK_ACCESS_TRANSFER_READ_BIT |
                        VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_READ_BIT}};
  const VkRenderPassCreateInfo info = {.sType = VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO,
                                       .attachmentCount = FRAME_DRAWN,
                                       .pAttachments = attachments,
                                       .subpassCount = 1,
                                       .pSubpasses = &subpass,
                                       .dependencyCount = 2,
                                       .pDependencies = dependencies};
  return gpu_check(d, d->CreateRenderPass(d->host.device, &info, NULL, &pass->render_pass), "the G-buffer's pass");
}

static bool create_pipeline(gpu_device *d, gbuffer_pass *pass) {
  const gpu_graphics_info info = {.what = "the G-buffer's pipeline",
                                  .layout = pass->layout,
                                  .render_pass = pass->render_pass,
                                  .vertex = GPU_CODE(VERTEX_SHADER),
                                  .fragment = GPU_CODE(FRAGMENT_SHADER),
                                  .colors = FRAME_COLORS,
                                  .depth = VK_COMPARE_OP_GREATER};
  return gpu_graphics_create(d, &info, &pass->pipeline);
}

bool gbuffer_pass_create(gpu_device *d, VkDescriptorSetLayout set_layout, gbuffer_pass *pass) {
  *pass = (gbuffer_pass){.pipeline = VK_NULL_HANDLE};
  const VkPhysicalDeviceLimits *limits = &d->properties.limits;
  if (limits->maxColorAttachments < FRAME_COLORS || limits->maxFragmentOutputAttachments < FRAME_COLORS ||
      limits->maxFragmentCombinedOutputResources < FRAME_COLORS + 1) {
    return gpu_fail(d, "the G-buffer needs %d color attachments and a buffer, which this device has not",
                    (int)FRAME_COLORS);
  }
  if (create_render_pass(d, pass) && scene_draw_layout(d, set_layout, &pass->layout) && create_pipeline(d, pass)) {
    return true;
  }
  gbuffer_pass_destroy(d, pass);
  return false;
}

void gbuffer_pass_destroy(gpu_device *d, gbuffer_pass *pass) {
  if (pass->framebuffer) d->DestroyFramebuffer(d->host.device, pass->framebuffer, NULL);
  if (pass->pipeline) d->DestroyPipeline(d->host.device, pass->pipeline, NULL);
  if (pass->layout) d->DestroyPipelineLayout(d->host.device, pass->layout, NULL);
  if (pass->render_pass) d->DestroyRenderPass(d->host.device, pass->render_pass, NULL);
  *pass = (gbuffer_pass){.pipeline = VK_NULL_HANDLE};
}

bool gbuffer_pass_attach(gpu_device *d, gbuffer_pass *pass, const frame_images *images) {
  if (pass->framebuffer) d->DestroyFramebuffer(d->host.device, pass->framebuffer, NULL);
  pass->framebuffer = VK_NULL_HANDLE;
  VkImageView views[FRAME_DRAWN];
  for (uint32_t i = 0; i < FRAME_DRAWN; i++) views[i] = images->images[i].view;
  const VkFramebufferCreateInfo info = {.sType = VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO,
                                        .renderPass = pass->render_pass,
                                        .attachmentCount = FRAME_DRAWN,
                                        .pAttachments = views,
                                        .width = images->width,
                                        .height = images->height,
                                        .layers = 1};
  return gpu_check(d, d->CreateFramebuffer(d->host.device, &info, NULL, &pass->framebuffer), "a framebuffer");
}

void gbuffer_pass_record(const gpu_device *d, const gbuffer_pass *pass, VkCommandBuffer commands,
                         const frame_images *images, const raster_view *view, const draw_item *items, uint32_t count) {
  const VkClearValue black[FRAME_DRAWN] = {{.color = {.float32 = {0}}}};
  const VkRenderPassBeginInfo begin = {.sType = VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO,
                                       .renderPass = pass->render_pass,
                                       .framebuffer = pass->framebuffer,
                                       .renderArea = {.extent = {images->width, images->height}},
                                       .clearValueCount = FRAME_DRAWN,
                                       .pClearValues = black};
  d->CmdBeginRenderPass(commands, &begin, VK_SUBPASS_CONTENTS_INLINE);
  gpu_viewport_record(d, commands, images->width, images->height);
  d->CmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pass->pipeline);
  scene_draw_record(d, commands, pass->layout, view->world_to_clip, view->lit.eye, items, count,
                    DRAW_OPAQUE | DRAW_MASKED);
  d->CmdEndRenderPass(commands);
}
