// Records the viewer's own passes over a lit frame: the image from the field alone, the pick, overlays, balls and the
// map.
#include "view_passes.h"
#include "shaders/view_shared.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

static const uint32_t spirv_primary[] = {
#include "view_primary.spv.inc"
};
static const uint32_t spirv_pick[] = {
#include "view_pick.spv.inc"
};
static const uint32_t spirv_overlay[] = {
#include "view_overlay.spv.inc"
};
static const uint32_t spirv_ball_corner[] = {
#include "view_ball_corner.spv.inc"
};
static const uint32_t spirv_ball[] = {
#include "view_ball.spv.inc"
};
static const uint32_t spirv_square[] = {
#include "view_square.spv.inc"
};
static const uint32_t spirv_map[] = {
#include "view_map.spv.inc"
};

_Static_assert(offsetof(view_gpu_push, eye) == 64, "push constants");
_Static_assert(offsetof(view_gpu_push, width) == 80, "push constants");
_Static_assert(offsetof(view_gpu_push, tracer) == 96, "push constants");
_Static_assert(offsetof(view_gpu_push, pick) == 112, "push constants");
_Static_assert(sizeof(view_gpu_push) == 128, "push constants");
_Static_assert(offsetof(view_gpu_pick, status) == 48 && sizeof(view_gpu_pick) == 64, "the pick");
_Static_assert(VIEW_PROBE_INDEX == VIEW_SHADE_BALL_INDEX && VIEW_PROBE_RADIANCE == VIEW_SHADE_BALL_RADIANCE &&
                   VIEW_PROBE_IRRADIANCE == VIEW_SHADE_BALL_IRRADIANCE && VIEW_WEIGHTS == VIEW_SHADE_WEIGHTS &&
                   VIEW_ANSWER == VIEW_SHADE_ANSWER && VIEW_UNRESOLVED == VIEW_SHADE_UNRESOLVED &&
                   VIEW_STEPS == VIEW_SHADE_STEPS,
               "overlays");

enum {
  PASS_SIZE = 8,
  EVERYWHERE = VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT | VK_SHADER_STAGE_COMPUTE_BIT
};

static bool create_layout(gpu_device *d, const olx_vulkan_field *field, view_passes *p) {
  static const VkDescriptorType types[VIEW_BINDINGS] = {
      VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER,
      VK_DESCRIPTOR_TYPE_STORAGE_IMAGE, VK_DESCRIPTOR_TYPE_STORAGE_IMAGE, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER};
  const VkSamplerCreateInfo sampler = {.sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO};
  if (!gpu_set_create(d, "the overlays", types, VIEW_BINDINGS, EVERYWHERE, &p->set) ||
      !gpu_check(d, d->CreateSampler(d->host.device, &sampler, NULL, &p->sampler), "the overlays' sampler")) {
    return false;
  }
  const VkDescriptorSetLayout sets[] = {olx_vulkan_field_set_layout(field), p->set.layout};
  return gpu_layout_create(d, "the overlays' layout", sets, 2, EVERYWHERE, sizeof(view_gpu_push), &p->layout);
}

static bool create_compute(gpu_device *d, view_passes *p, view_pipeline which, gpu_code code) {
  return gpu_compute_pipeline_create(d, "an overlay's pipeline", code, p->layout, &p->pipelines[which]);
}

// Creates a pipeline for squares of four corners each, blended over the image; nearer ones occlude others.
static bool create_squares(gpu_device *d, view_passes *p, view_pipeline which, gpu_code vertex, gpu_code fragment) {
  const gpu_graphics_info info = {.what = "an overlay's pipeline",
                                  .layout = p->layout,
                                  .render_pass = p->screen,
                                  .vertex = vertex,
                                  .fragment = fragment,
                                  .strip = true,
                                  .blended = true,
                                  .colors = 1,
                                  .depth = VK_COMPARE_OP_GREATER_OR_EQUAL};
  return gpu_graphics_create(d, &info, &p->pipelines[which]);
}

bool view_passes_create(gpu_device *d, const olx_vulkan_field *field, VkRenderPass screen, view_passes *p) {
  *p = (view_passes){.field_set = olx_vulkan_field_set(field), .screen = screen};
  const VkBufferUsageFlags use = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT;
  if (!gpu_buffer_create(d, "the pick", sizeof(view_gpu_pick), use, true, &p->pick)) return false;
  *(view_gpu_pick *)p->pick.mapped = (view_gpu_pick){.probe = UINT32_MAX};
  return create_layout(d, field, p);
}

static bool make_pipeline(gpu_device *d, view_passes *p, view_pipeline which) {
  switch (which) {
  case VIEW_PIPELINE_PRIMARY: return create_compute(d, p, which, GPU_CODE(spirv_primary));
  case VIEW_PIPELINE_PICK: return create_compute(d, p, which, GPU_CODE(spirv_pick));
  case VIEW_PIPELINE_OVERLAY: return create_compute(d, p, which, GPU_CODE(spirv_overlay));
  case VIEW_PIPELINE_BALLS: return create_squares(d, p, which, GPU_CODE(spirv_ball_corner), GPU_CODE(spirv_ball));
  case VIEW_PIPELINE_MAP: return create_squares(d, p, which, GPU_CODE(spirv_square), GPU_CODE(spirv_map));
  case VIEW_PIPELINES: break;
  }
  return false;
}

static bool is_wanted(view_pipeline which, const view_state *s) {
  switch (which) {
  case VIEW_PIPELINE_PRIMARY: return s->mode == VIEW_PROBES;
  case VIEW_PIPELINE_PICK: return s->picked;
  case VIEW_PIPELINE_OVERLAY: return s->overlay >= VIEW_WEIGHTS && s->overlay <= VIEW_STEPS;
  case VIEW_PIPELINE_BALLS: return s->overlay >= VIEW_PROBE_INDEX && s->overlay <= VIEW_PROBE_IRRADIANCE;
  case VIEW_PIPELINE_MAP: return s->overlay == VIEW_MAP;
  case VIEW_PIPELINES: break;
  }
  return false;
}

bool view_passes_are_ready(const view_passes *p, const view_state *state) {
  for (view_pipeline which = 0; which < VIEW_PIPELINES; which++) {
    if (!p->pipelines[which] && is_wanted(which, state)) return false;
  }
  return true;
}

bool view_passes_prepare(gpu_device *d, view_passes *p, const view_state *state) {
  for (view_pipeline which = 0; which < VIEW_PIPELINES; which++) {
    if (!p->pipelines[which] && is_wanted(which, state) && !make_pipeline(d, p, which)) return false;
  }
  return true;
}

void view_passes_destroy(gpu_device *d, view_passes *p) {
  if (!d->host.device) return;
  for (int i = 0; i < VIEW_PIPELINES; i++) {
    if (p->pipelines[i]) d->DestroyPipeline(d->host.device, p->pipelines[i], NULL);
  }
  if (p->layout) d->DestroyPipelineLayout(d->host.device, p->layout, NULL);
  if (p->sampler) d->DestroySampler(d->host.device, p->sampler, NULL);
  gpu_set_destroy(d, &p->set);
  gpu_buffer_destroy(d, &p->pick);
  *p = (view_passes){.layout = VK_NULL_HANDLE};
}

void view_passes_attach(gpu_device *d, view_passes *p, const frame_images *images) {
  static const struct {
    frame_image image;
    VkImageLayout layout;
  } shown[] = {{FRAME_DEPTH, VK_IMAGE_LAYOUT_DEPTH_STENCIL_READ_ONLY_OPTIMAL},
               {FRAME_NORMAL, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL},
               {FRAME_COLOR, VK_IMAGE_LAYOUT_GENERAL},
               {FRAME_DISPLAY, VK_IMAGE_LAYOUT_GENERAL}};
  gpu_binding bindings[VIEW_BINDINGS];
  for (uint32_t i = 0; i < VIEW_BINDING_PICK; i++) {
    bindings[i] = (gpu_binding){.type = i <= VIEW_BINDING_NORMAL ? VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER
                                                                 : VK_DESCRIPTOR_TYPE_STORAGE_IMAGE,
                                .view = images->images[shown[i].image].view,
                                .sampler = i <= VIEW_BINDING_NORMAL ? p->sampler : VK_NULL_HANDLE,
                                .layout = shown[i].layout};
  }
  bindings[VIEW_BINDING_PICK] = (gpu_binding){.type = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, .buffer = &p->pick};
  gpu_set_write(d, &p->set, bindings, VIEW_BINDINGS);
}

// Returns the pixel at a share of the picture's side, or the nearest one: a hidden cursor may be anywhere.
static float pixel_of(float share, uint32_t side) {
  return fmaxf(0.0f, fminf(floorf(share * (float)side), (float)side - 1.0f));
}

static view_gpu_push make_push(const view_frame *f, const float matrix[16]) {
  const view_state *s = f->state;
  const uint32_t width = f->images->width, height = f->images->height;
  const olx_vec3 eye = f->view->lit.eye;
  view_gpu_push push = {.eye = {eye.x, eye.y, eye.z, f->view->lit.empty_depth},
                        .width = width,
                        .height = height,
                        .overlay = s->overlay,
                        .flags = (s->visibility ? VIEW_FLAG_VISIBILITY : 0u) |
                                 (s->keep_buried ? VIEW_FLAG_KEEP_BURIED : 0u) |
                                 (s->hits == OLX_HITS_STORED ? VIEW_FLAG_STORED : 0u) |
                                 (s->mode == VIEW_PROBES ? VIEW_FLAG_EYE_RAYS : 0u),
                        .tracer = s->tracer,
                        .select = s->select,
                        .probe = s->probe,
                        .exposure = s->exposure,
                        .pick = {pixel_of(s->pick[0], width), pixel_of(s->pick[1], height)},
                        .radius = s->probe_radius,
                        .scale = (float)width / (float)f->width};
  memcpy(push.matrix, matrix, sizeof push.matrix);
  return push;
}

static void bind(const gpu_device *d, const view_passes *p, VkCommandBuffer commands, view_pipeline which,
                 const view_gpu_push *push) {
  const VkPipelineBindPoint point =
      which >= VIEW_PIPELINE_BALLS ? VK_PIPELINE_BIND_POINT_GRAPHICS : VK_PIPELINE_BIND_POINT_COMPUTE;
  const VkDescriptorSet sets[] = {p->field_set, p->set.set};
  d->CmdBindPipeline(commands, point, p->pipelines[which]);
  d->CmdBindDescriptorSets(commands, point, p->layout, 0, 2, sets, 0, NULL);
  d->CmdPushConstants(commands, p->layout, EVERYWHERE, 0, sizeof *push, push);
}

static void dispatch(const gpu_device *d, const view_passes *p, VkCommandBuffer commands, view_pipeline which,
                     const view_gpu_push *push) {
  bind(d, p, commands, which, push);
  if (which == VIEW_PIPELINE_PICK) d->CmdDispatch(commands, 1, 1, 1);
  else
    d->CmdDispatch(commands, (push->width + PASS_SIZE - 1) / PASS_SIZE, (push->height + PASS_SIZE - 1) / PASS_SIZE, 1);
}

void view_passes_record_primary(const gpu_device *d, const view_passes *p, VkCommandBuffer commands,
                                const view_frame *frame) {
  const view_gpu_push push = make_push(frame, frame->view->lit.clip_to_world);
  dispatch(d, p, commands, VIEW_PIPELINE_PRIMARY, &push);
}

void view_passes_record_overlay(const gpu_device *d, const view_passes *p, VkCommandBuffer commands,
                                const view_frame *frame) {
  const view_gpu_push push = make_push(frame, frame->view->lit.clip_to_world);
  gpu_memory_barrier(d, commands, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_ACCESS_SHADER_WRITE_BIT,
                     VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT);
  if (is_wanted(VIEW_PIPELINE_OVERLAY, frame->state)) dispatch(d, p, commands, VIEW_PIPELINE_OVERLAY, &push);
  if (frame->state->picked) dispatch(d, p, commands, VIEW_PIPELINE_PICK, &push);
  gpu_memory_barrier(d, commands, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_ACCESS_SHADER_WRITE_BIT,
                     VK_PIPELINE_STAGE_TRANSFER_BIT | VK_PIPELINE_STAGE_FRAGMENT_SHADER_BIT |
                         VK_PIPELINE_STAGE_HOST_BIT,
                     VK_ACCESS_TRANSFER_READ_BIT | VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_HOST_READ_BIT);
}

void view_passes_record_balls(const gpu_device *d, const view_passes *p, VkCommandBuffer commands,
                              const view_frame *frame) {
  const view_gpu_push push = make_push(frame, frame->view->world_to_clip);
  bind(d, p, commands, VIEW_PIPELINE_BALLS, &push);
  const bool irradiance = frame->state->overlay == VIEW_PROBE_IRRADIANCE;
  d->CmdDraw(commands, 4, irradiance ? frame->field->irradiance.probe_count : frame->field->probes.count, 0, 0);
}

void view_passes_record_map(const gpu_device *d, const view_passes *p, VkCommandBuffer commands,
                            const view_frame *frame) {
  static const float share = 0.55f, margin = 12.0f; // share of the window's shorter side; margin in pixels
  view_gpu_push push = make_push(frame, frame->view->world_to_clip);
  const float side = floorf(share * fminf((float)frame->width, (float)frame->height));
  push.width = frame->width;
  push.height = frame->height;
  push.radius = side;
  push.pick = (view_gpu_vec2){(float)frame->width - side - margin, (float)frame->height - side - margin};
  bind(d, p, commands, VIEW_PIPELINE_MAP, &push);
  d->CmdDraw(commands, 4, 1, 0, 0);
}

view_pick view_passes_read_pick(const view_passes *p) {
  const view_gpu_pick *found = p->pick.mapped;
  return (view_pick){.valid = found->position.w > 0.0f,
                     .position = {found->position.x, found->position.y, found->position.z},
                     .normal = {found->normal.x, found->normal.y, found->normal.z},
                     .direction = {found->direction.x, found->direction.y, found->direction.z},
                     .status = found->status,
                     .distance_metres = found->direction.w,
                     .probe = found->probe,
                     .steps = found->steps,
                     .probes_tried = found->tried};
}
