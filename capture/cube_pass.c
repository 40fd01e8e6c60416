// Draws the faces of cubes around probes, without the chunks of triangles that lie outside of a face.
#include "cube_pass.h"

static const uint32_t VERTEX_SHADER[] = {
#include "cube.spv.inc"
};
static const uint32_t MASK_VERTEX_SHADER[] = {
#include "cube_mask.spv.inc"
};
static const uint32_t FRAGMENT_SHADER[] = {
#include "cube_seen.spv.inc"
};
static const uint32_t MASK_FRAGMENT_SHADER[] = {
#include "cube_mask_seen.spv.inc"
};

enum { TRIANGLES, DEPTH, ATTACHMENTS };

static const VkShaderStageFlags STAGES = VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT;

// As in shaders/cube_shared.glsl.
typedef struct face_constants {
  float eye[3], near;
  uint32_t axis;
  float side, scale;
  uint32_t flags;
  float alpha, alpha_cutoff;
} face_constants;

// ---- Creating

static bool create_images(gpu_device *d, cube_pass *pass) {
  const gpu_image_info triangles = {.what = "a face of a cube map",
                                    .format = VK_FORMAT_R32_UINT,
                                    .width = pass->side,
                                    .height = pass->side,
                                    .usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT};
  gpu_image_info depth = triangles;
  depth.format = VK_FORMAT_D32_SFLOAT;
  depth.usage = VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT;
  return gpu_image_create(d, &triangles, &pass->triangles) && gpu_image_create(d, &depth, &pass->depth);
}

static VkAttachmentDescription attachment(VkFormat format, VkAttachmentStoreOp store, VkImageLayout layout) {
  return (VkAttachmentDescription){.format = format,
                                   .samples = VK_SAMPLE_COUNT_1_BIT,
                                   .loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR,
                                   .storeOp = store,
                                   .stencilLoadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE,
                                   .stencilStoreOp = VK_ATTACHMENT_STORE_OP_DONT_CARE,
                                   .initialLayout = VK_IMAGE_LAYOUT_UNDEFINED,
                                   .finalLayout = layout};
}

// The images of a face are used for the next face once they are copied.
static bool create_render_pass(gpu_device *d, cube_pass *pass) {
  const VkImageLayout depth_layout = VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL;
  const VkAttachmentDescription attachments[ATTACHMENTS] = {
      [TRIANGLES] =
          attachment(pass->triangles.format, VK_ATTACHMENT_STORE_OP_STORE, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL),
      [DEPTH] = attachment(pass->depth.format, VK_ATTACHMENT_STORE_OP_DONT_CARE, depth_layout)};
  const VkAttachmentReference color = {TRIANGLES, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL},
                              depth = {DEPTH, depth_layout};
  const VkSubpassDescription subpass = {.pipelineBindPoint = VK_PIPELINE_BIND_POINT_GRAPHICS,
                                        .colorAttachmentCount = 1,
                                        .pColorAttachments = &color,
                                        .pDepthStencilAttachment = &depth};
  const VkPipelineStageFlags tests =
      VK_PIPELINE_STAGE_EARLY_FRAGMENT_TESTS_BIT | VK_PIPELINE_STAGE_LATE_FRAGMENT_TESTS_BIT;
  const VkAccessFlags depth_access =
      VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_READ_BIT | VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT;
  const VkSubpassDependency dependencies[2] = {
      {.srcSubpass = VK_SUBPASS_EXTERNAL,
       .dstSubpass = 0,
       .srcStageMask = VK_PIPELINE_STAGE_TRANSFER_BIT | tests,
       .dstStageMask = VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT | tests,
       .srcAccessMask = VK_ACCESS_TRANSFER_READ_BIT | VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT,
       .dstAccessMask = VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT | depth_access},
      {.srcSubpass = 0,
       .dstSubpass = VK_SUBPASS_EXTERNAL,
       .srcStageMask = VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT,
       .dstStageMask = VK_PIPELINE_STAGE_TRANSFER_BIT,
       .srcAccessMask = VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT,
       .dstAccessMask = VK_ACCESS_TRANSFER_READ_BIT}};
  const VkRenderPassCreateInfo info = {.sType = VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO,
                                       .attachmentCount = ATTACHMENTS,
                                       .pAttachments = attachments,
                                       .subpassCount = 1,
                                       .pSubpasses = &subpass,
                                       .dependencyCount = 2,
                                       .pDependencies = dependencies};
  return gpu_check(d, d->CreateRenderPass(d->host.device, &info, NULL, &pass->render_pass), "the pass of a face");
}

static bool create_framebuffer(gpu_device *d, cube_pass *pass) {
  const VkImageView views[ATTACHMENTS] = {[TRIANGLES] = pass->triangles.view, [DEPTH] = pass->depth.view};
  const VkFramebufferCreateInfo info = {.sType = VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO,
                                        .renderPass = pass->render_pass,
                                        .attachmentCount = ATTACHMENTS,
                                        .pAttachments = views,
                                        .width = pass->side,
                                        .height = pass->side,
                                        .layers = 1};
  return gpu_check(d, d->CreateFramebuffer(d->host.device, &info, NULL, &pass->framebuffer), "a face's framebuffer");
}

static bool create_pipelines(gpu_device *d, const cube_scene *scene, cube_pass *pass) {
  gpu_graphics_info info = {.what = "the pipeline of a face",
                            .render_pass = pass->render_pass,
                            .vertex = GPU_CODE(VERTEX_SHADER),
                            .fragment = GPU_CODE(FRAGMENT_SHADER),
                            .colors = 1,
                            .depth = VK_COMPARE_OP_GREATER};
  if (!gpu_layout_create(d, info.what, &scene->opaque.layout, 1, STAGES, sizeof(face_constants), &pass->layout))
    return false;
  info.layout = pass->layout;
  if (!gpu_graphics_create(d, &info, &pass->opaque)) return false;
  info.vertex = GPU_CODE(MASK_VERTEX_SHADER);
  info.fragment = GPU_CODE(MASK_FRAGMENT_SHADER);
  return gpu_graphics_create(d, &info, &pass->masked);
}

bool cube_pass_create(gpu_device *d, const cube_scene *scene, uint32_t side, float near, cube_pass *pass) {
  *pass = (cube_pass){.side = side, .near = near};
  return create_images(d, pass) && create_render_pass(d, pass) && create_framebuffer(d, pass) &&
         create_pipelines(d, scene, pass);
}

void cube_pass_destroy(gpu_device *d, cube_pass *pass) {
  if (pass->opaque) d->DestroyPipeline(d->host.device, pass->opaque, NULL);
  if (pass->masked) d->DestroyPipeline(d->host.device, pass->masked, NULL);
  if (pass->layout) d->DestroyPipelineLayout(d->host.device, pass->layout, NULL);
  if (pass->framebuffer) d->DestroyFramebuffer(d->host.device, pass->framebuffer, NULL);
  if (pass->render_pass) d->DestroyRenderPass(d->host.device, pass->render_pass, NULL);
  gpu_image_destroy(d, &pass->triangles);
  gpu_image_destroy(d, &pass->depth);
  *pass = (cube_pass){.side = 0};
}

// ---- Recording

// Returns whether a chunk may lie in a face's pyramid: whether, along each of the other two axes, it overlaps what the
// pyramid spans at the chunk's farthest depth.
static bool in_face(const cube_chunk *chunk, const face_constants *face) {
  const float reach = 1.001f / face->scale; // of the face's coordinates, with a margin for rounding
  const uint32_t axis = face->axis;
  const float from = chunk->low[axis] - face->eye[axis], to = chunk->high[axis] - face->eye[axis];
  const float farthest = face->side > 0.0f ? to : -from;
  if (farthest <= 0.0f) return false;
  for (uint32_t k = 1; k < 3; k++) {
    const uint32_t other = (axis + k) % 3;
    const float low = chunk->low[other] - face->eye[other], high = chunk->high[other] - face->eye[other];
    if (low > reach * farthest || high < -reach * farthest) return false;
  }
  return true;
}

static void bind(const gpu_device *d, const cube_pass *pass, VkPipeline pipeline, const gpu_set *set,
                 const face_constants *face) {
  d->CmdBindPipeline(d->commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline);
  d->CmdBindDescriptorSets(d->commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pass->layout, 0, 1, &set->set, 0, NULL);
  d->CmdPushConstants(d->commands, pass->layout, STAGES, 0, sizeof *face, face);
}

// Binds what the triangles of a chunk are drawn with.
static void bind_mask(const gpu_device *d, const cube_pass *pass, const cube_scene *scene, uint32_t index,
                      face_constants *face) {
  if (index == CUBE_OPAQUE) {
    bind(d, pass, pass->opaque, &scene->opaque, face);
    return;
  }
  const cube_mask *mask = &scene->masks[index];
  face->flags = mask->flags;
  face->alpha = mask->alpha;
  face->alpha_cutoff = mask->alpha_cutoff;
  bind(d, pass, pass->masked, &mask->set, face);
}

// Draws the chunks in the face, as many at once as follow each other.
static void draw_chunks(const gpu_device *d, const cube_pass *pass, const cube_scene *scene, face_constants *face) {
  bool bound = false;
  uint32_t mask = CUBE_OPAQUE;
  for (uint32_t i = 0; i < scene->chunk_count;) {
    const cube_chunk *chunk = &scene->chunks[i++];
    if (!in_face(chunk, face)) continue;
    uint32_t count = chunk->count;
    for (; i < scene->chunk_count && scene->chunks[i].mask == chunk->mask && in_face(&scene->chunks[i], face); i++) {
      count += scene->chunks[i].count;
    }
    if (!bound || chunk->mask != mask) bind_mask(d, pass, scene, chunk->mask, face);
    bound = true;
    mask = chunk->mask;
    d->CmdDraw(d->commands, 3 * count, 1, 3 * chunk->first, 0);
  }
}

void cube_pass_record(const gpu_device *d, const cube_pass *pass, const cube_scene *scene, olx_vec3 eye, uint32_t face,
                      const gpu_buffer *buffer, VkDeviceSize offset) {
  const VkClearValue empty[ATTACHMENTS] = {
      [TRIANGLES] = {.color = {.uint32 = {UINT32_MAX}}}, [DEPTH] = {.depthStencil = {0.0f, 0}}};
  const VkRenderPassBeginInfo begin = {.sType = VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO,
                                       .renderPass = pass->render_pass,
                                       .framebuffer = pass->framebuffer,
                                       .renderArea = {.extent = {pass->side, pass->side}},
                                       .clearValueCount = ATTACHMENTS,
                                       .pClearValues = empty};
  face_constants constants = {.eye = {eye.x, eye.y, eye.z},
                              .near = pass->near,
                              .axis = face / 2,
                              .side = face % 2 ? -1.0f : 1.0f,
                              .scale = (float)(pass->side - 2) / (float)pass->side};
  d->CmdBeginRenderPass(d->commands, &begin, VK_SUBPASS_CONTENTS_INLINE);
  gpu_viewport_record(d, d->commands, pass->side, pass->side);
  draw_chunks(d, pass, scene, &constants);
  d->CmdEndRenderPass(d->commands);
  const VkBufferImageCopy region = {.bufferOffset = offset,
                                    .imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                                    .imageExtent = {pass->side, pass->side, 1}};
  d->CmdCopyImageToBuffer(d->commands, pass->triangles.image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, buffer->buffer, 1,
                          &region);
}
