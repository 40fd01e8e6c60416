// Scales the lit image to the window's size, with everything that is drawn over it, and saves it as PNG.
#include "view_screen.h"

#include <octalux/render.h>

#include <stdlib.h>

static const VkFormat COLOR_FORMAT = VK_FORMAT_R8G8B8A8_UNORM, DEPTH_FORMAT = VK_FORMAT_D32_SFLOAT;

bool view_screen_create(gpu_device *d, view_screen *screen) {
  *screen = (view_screen){.framebuffer = VK_NULL_HANDLE};
  const VkAttachmentDescription attachments[] = {{.format = COLOR_FORMAT,
                                                  .samples = VK_SAMPLE_COUNT_1_BIT,
                                                  .loadOp = VK_ATTACHMENT_LOAD_OP_LOAD,
                                                  .storeOp = VK_ATTACHMENT_STORE_OP_STORE,
                                                  .initialLayout = VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                                                  .finalLayout = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL},
                                                 {.format = DEPTH_FORMAT,
                                                  .samples = VK_SAMPLE_COUNT_1_BIT,
                                                  .loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR,
                                                  .storeOp = VK_ATTACHMENT_STORE_OP_DONT_CARE,
                                                  .stencilLoadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE,
                                                  .stencilStoreOp = VK_ATTACHMENT_STORE_OP_DONT_CARE,
                                                  .initialLayout = VK_IMAGE_LAYOUT_UNDEFINED,
                                                  .finalLayout = VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL}};
  const VkAttachmentReference color = {0, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL},
                              depth = {1, VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL};
  const VkSubpassDescription subpass = {.pipelineBindPoint = VK_PIPELINE_BIND_POINT_GRAPHICS,
                                        .colorAttachmentCount = 1,
                                        .pColorAttachments = &color,
                                        .pDepthStencilAttachment = &depth};
  const VkPipelineStageFlags depth_stages =
      VK_PIPELINE_STAGE_EARLY_FRAGMENT_TESTS_BIT | VK_PIPELINE_STAGE_LATE_FRAGMENT_TESTS_BIT;
  const VkSubpassDependency dependencies[] = {
      {.srcSubpass = VK_SUBPASS_EXTERNAL,
       .srcStageMask = VK_PIPELINE_STAGE_TRANSFER_BIT | VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT | depth_stages,
       .dstStageMask =
           VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT | VK_PIPELINE_STAGE_FRAGMENT_SHADER_BIT | depth_stages,
       .srcAccessMask =
           VK_ACCESS_TRANSFER_WRITE_BIT | VK_ACCESS_SHADER_WRITE_BIT | VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT,
       .dstAccessMask = VK_ACCESS_COLOR_ATTACHMENT_READ_BIT | VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT |
                        VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_READ_BIT |
                        VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT},
      {.dstSubpass = VK_SUBPASS_EXTERNAL,
       .srcStageMask = VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT | VK_PIPELINE_STAGE_FRAGMENT_SHADER_BIT,
       .dstStageMask = VK_PIPELINE_STAGE_TRANSFER_BIT | VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT,
       .srcAccessMask = VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT,
       .dstAccessMask = VK_ACCESS_TRANSFER_READ_BIT}};
  const VkRenderPassCreateInfo info = {.sType = VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO,
                                       .attachmentCount = 2,
                                       .pAttachments = attachments,
                                       .subpassCount = 1,
                                       .pSubpasses = &subpass,
                                       .dependencyCount = 2,
                                       .pDependencies = dependencies};
  return gpu_check(d, d->CreateRenderPass(d->host.device, &info, NULL, &screen->render_pass),
                   "the screen's render pass");
}

static void drop_picture(gpu_device *d, view_screen *screen) {
  if (screen->framebuffer) d->DestroyFramebuffer(d->host.device, screen->framebuffer, NULL);
  screen->framebuffer = VK_NULL_HANDLE;
  gpu_image_destroy(d, &screen->picture);
  gpu_image_destroy(d, &screen->depth);
}

bool view_screen_resize(gpu_device *d, uint32_t width, uint32_t height, view_screen *screen) {
  drop_picture(d, screen);
  const VkImageUsageFlags uses =
      VK_IMAGE_USAGE_TRANSFER_DST_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT;
  const gpu_image_info picture = {"the screen's picture", COLOR_FORMAT, width, height, 0, 0, uses};
  const gpu_image_info depth = {
      "the screen's depth", DEPTH_FORMAT, width, height, 0, 0, VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT};
  if (!gpu_image_create(d, &picture, &screen->picture) || !gpu_image_create(d, &depth, &screen->depth)) return false;
  const VkImageView views[] = {screen->picture.view, screen->depth.view};
  const VkFramebufferCreateInfo info = {.sType = VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO,
                                        .renderPass = screen->render_pass,
                                        .attachmentCount = 2,
                                        .pAttachments = views,
                                        .width = width,
                                        .height = height,
                                        .layers = 1};
  return gpu_check(d, d->CreateFramebuffer(d->host.device, &info, NULL, &screen->framebuffer),
                   "the screen's framebuffer");
}

void view_screen_destroy(gpu_device *d, view_screen *screen) {
  if (!d->host.device) return;
  drop_picture(d, screen);
  if (screen->render_pass) d->DestroyRenderPass(d->host.device, screen->render_pass, NULL);
  screen->render_pass = VK_NULL_HANDLE;
}

void view_screen_begin(const gpu_device *d, const view_screen *screen, VkCommandBuffer commands,
                       const gpu_image *display) {
  const gpu_image *picture = &screen->picture;
  const VkImageBlit whole = {.srcSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                             .srcOffsets = {{0, 0, 0}, {(int32_t)display->width, (int32_t)display->height, 1}},
                             .dstSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                             .dstOffsets = {{0, 0, 0}, {(int32_t)picture->width, (int32_t)picture->height, 1}}};
  gpu_image_barrier(d, commands, picture, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
  gpu_image_barrier(d, commands, display, VK_IMAGE_LAYOUT_GENERAL, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
  d->CmdBlitImage(commands, display->image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, picture->image,
                  VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &whole,
                  display->width == picture->width ? VK_FILTER_NEAREST : VK_FILTER_LINEAR);
  gpu_image_barrier(d, commands, display, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, VK_IMAGE_LAYOUT_GENERAL);
  const VkRect2D all = {{0, 0}, {picture->width, picture->height}};
  const VkClearValue clear[] = {{.color = {.float32 = {0}}}, {.depthStencil = {0.0f, 0}}};
  const VkRenderPassBeginInfo info = {.sType = VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO,
                                      .renderPass = screen->render_pass,
                                      .framebuffer = screen->framebuffer,
                                      .renderArea = all,
                                      .clearValueCount = 2,
                                      .pClearValues = clear};
  d->CmdBeginRenderPass(commands, &info, VK_SUBPASS_CONTENTS_INLINE);
  const VkViewport viewport = {0, 0, (float)picture->width, (float)picture->height, 0.0f, 1.0f};
  d->CmdSetViewport(commands, 0, 1, &viewport);
  d->CmdSetScissor(commands, 0, 1, &all);
}

void view_screen_end(const gpu_device *d, VkCommandBuffer commands) { d->CmdEndRenderPass(commands); }

bool view_screen_save(gpu_device *d, const view_screen *screen, const char *path) {
  const gpu_image *picture = &screen->picture;
  const size_t pixels = (size_t)picture->width * picture->height;
  gpu_buffer copy;
  uint8_t *rgb = NULL, *png = NULL;
  size_t png_bytes;
  bool saved = gpu_buffer_create(d, "a screenshot", 4 * pixels, VK_BUFFER_USAGE_TRANSFER_DST_BIT, true, &copy) &&
               gpu_image_read(d, picture, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, &copy);
  if (saved && !(rgb = malloc(3 * pixels))) saved = gpu_fail(d, "%s: out of memory", path);
  for (size_t i = 0; saved && i < pixels; i++) {
    const uint8_t *from = (const uint8_t *)copy.mapped + 4 * i;
    for (int c = 0; c < 3; c++) rgb[3 * i + (size_t)c] = from[c];
  }
  if (saved) {
    saved = gpu_check_library(d, olx_png_encode(picture->width, picture->height, 3, rgb, &png, &png_bytes)) &&
            gpu_check_library(d, olx_write_file(path, png, png_bytes));
  }
  olx_png_free(png);
  free(rgb);
  gpu_buffer_destroy(d, &copy);
  return saved;
}
