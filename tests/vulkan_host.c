// Acts as the host of the recorded passes in tests: opens a device, uploads a room's surfaces as images, and reads back
// the passes' outputs.
#include "vulkan_host.h"

#include "core/pack.h"
#include "core/sampling.h"
#include "pinned_drivers.h"

#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

bool host_open_device(gpu_device *device, bool validate) {
  pin_drivers();
  const gpu_device_options options = {.validate = validate, .compute_only = true, .device = UINT32_MAX};
  return gpu_device_open(&options, device);
}

void host_need_device(const gpu_device *device) {
  if (device->host.device) return;
  print_message("skipped: %s\n", device->problem);
  skip();
}

int host_close_device(gpu_device *device) {
  const uint32_t before = device->validation_messages;
  gpu_device_close(device);
  return device->validation_messages == before ? 0 : 1;
}

static olx_vec3 bent_normal(olx_vec3 normal, uint32_t x, uint32_t y, float bend) {
  const olx_vec3 aside = olx_v3(sinf(0.3f * (float)x), sinf(0.4f * (float)y), sinf(0.2f * (float)(x + y)));
  return bend > 0.0f ? olx_normalize(olx_madd(normal, aside, bend)) : normal;
}

static olx_vec3 turned_normal(olx_vec3 normal, olx_vec3 view) {
  const float cosine = olx_dot(normal, view), least = OLX_LEAST_VIEW_COSINE;
  return cosine < least ? olx_normalize(olx_madd(normal, view, least - cosine)) : normal;
}

host_pixel host_pixel_at(const host_view *v, uint32_t x, uint32_t y) {
  const float cx = ((float)x + v->shift.x + 0.5f) / (float)v->width * 2.0f - 1.0f,
              cy = ((float)y + v->shift.y + 0.5f) / (float)v->height * 2.0f - 1.0f;
  const olx_vec3 along = olx_v3(cx * HOST_SPREAD, -cy * HOST_SPREAD, -1.0f), d = olx_normalize(along);
  const analytic_hit hit = analytic_cast(v->scene, v->eye, d);
  const uint32_t h = olx_hash2(x, y);
  host_pixel p = {.empty = x < 4,
                  .stored_normal = bent_normal(hit.normal, x, y, v->bend),
                  .geometric_normal = hit.normal,
                  .vertex_normal = bent_normal(hit.normal, x, y, 0.2f * v->bend),
                  .dynamic = (x / 4 + y / 4) % 2 != 0,
                  .view = olx_negate(d),
                  .color = olx_v3(0.9f, 0.5f, 0.25f),
                  .roughness = (float)(h & 255u) / 255.0f,
                  .metallic = h & 256u ? 0.0f : 0.75f,
                  .weight = h & 512u ? 1.0f : 0.5f};
  p.normal = turned_normal(p.stored_normal, p.view);
  p.depth = p.empty ? 0.0f : HOST_NEAR / (-d.z * hit.t);
  // Distance along the view comes from the stored depth, as in the passes.
  p.metres = HOST_NEAR / (p.empty ? 1.0f : p.depth);
  p.position = olx_madd(v->eye, along, p.metres);
  return p;
}

olx_vulkan_view host_vulkan_view(const host_view *v) {
  // The matrix takes clip (x, y, depth, 1) to (x + sx, -(y + sy), -1 / spread) spread near / depth + eye.
  const float sx = 2.0f * v->shift.x / (float)v->width, sy = 2.0f * v->shift.y / (float)v->height;
  const float side = HOST_SPREAD * HOST_NEAR;
  return (olx_vulkan_view){.clip_to_world = {side, 0, 0, 0, 0, -side, 0, 0, v->eye.x, v->eye.y, v->eye.z, 1, sx * side,
                                             -sy * side, -HOST_NEAR, 0},
                           .eye = v->eye,
                           .empty_depth = 0.0f};
}

host_images host_images_make(gpu_device *device, uint32_t width, uint32_t height, VkFormat normal) {
  host_images h = {.device = device, .width = width, .height = height};
  const VkFormat formats[HOST_INPUTS] = {VK_FORMAT_R32_SFLOAT, normal, VK_FORMAT_R8G8B8A8_UNORM,
                                         VK_FORMAT_R8G8B8A8_UNORM, normal, normal, VK_FORMAT_R8G8B8A8_UNORM};
  const VkBufferUsageFlags both = VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT;
  const VkDeviceSize bytes = (VkDeviceSize)width * height * 16 * HOST_INPUTS;
  assert_true(gpu_buffer_create(device, "staging", bytes, both, true, &h.staging));
  gpu_image_info info = {.what = "an input",
                         .width = width,
                         .height = height,
                         .usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT};
  for (uint32_t i = 0; i < HOST_INPUTS; i++) {
    info.format = formats[i];
    assert_true(gpu_image_create(device, &info, &h.inputs[i]));
  }
  info.what = "an output";
  info.format = VK_FORMAT_R16G16B16A16_SFLOAT;
  info.usage = VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT;
  for (uint32_t i = 0; i < HOST_OUTPUTS; i++) assert_true(gpu_image_create(device, &info, &h.outputs[i]));
  const VkImageLayout read = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL;
  h.targets = (olx_vulkan_targets){.width = width,
                                   .height = height,
                                   .depth = {h.inputs[0].view, formats[0], read},
                                   .normal = {h.inputs[1].view, formats[1], read},
                                   .albedo = {h.inputs[2].view, formats[2], read},
                                   .roughness = {h.inputs[3].view, formats[3], read},
                                   .irradiance = h.outputs[0].view,
                                   .glossy = h.outputs[1].view,
                                   .color = h.outputs[2].view};
  return h;
}

olx_vulkan_image host_input(const host_images *h, uint32_t input) {
  return (olx_vulkan_image){h->inputs[input].view, h->inputs[input].format, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL};
}

void host_images_free(host_images *h) {
  for (uint32_t i = 0; i < HOST_INPUTS; i++) gpu_image_destroy(h->device, &h->inputs[i]);
  for (uint32_t i = 0; i < HOST_OUTPUTS; i++) gpu_image_destroy(h->device, &h->outputs[i]);
  gpu_buffer_destroy(h->device, &h->staging);
}

static VkBufferImageCopy whole_image(const host_images *h, VkDeviceSize offset) {
  return (VkBufferImageCopy){.bufferOffset = offset,
                             .imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                             .imageExtent = {h->width, h->height, 1}};
}

static uint32_t unorm(olx_vec3 v) {
  return (uint32_t)(v.x * 255.0f + 0.5f) | (uint32_t)(v.y * 255.0f + 0.5f) << 8 | (uint32_t)(v.z * 255.0f + 0.5f) << 16;
}

static VkDeviceSize plane(const host_images *h, uint32_t image) {
  return (VkDeviceSize)h->width * h->height * 16 * image;
}

static void stage_normal(host_images *h, uint32_t input, uint32_t pixel, olx_vec3 normal) {
  char *memory = (char *)h->staging.mapped + plane(h, input);
  if (h->inputs[input].format == VK_FORMAT_R8G8B8A8_UNORM) {
    ((uint32_t *)(void *)memory)[pixel] = unorm(olx_madd(olx_splat(0.5f), normal, 0.5f));
  } else {
    const float n[4] = {normal.x, normal.y, normal.z, 0.0f};
    memcpy(memory + (size_t)16 * pixel, n, sizeof n);
  }
}

void host_upload(host_images *h, const host_view *view) {
  gpu_device *device = h->device;
  char *memory = h->staging.mapped;
  for (uint32_t i = 0; i < h->width * h->height; i++) {
    const host_pixel p = host_pixel_at(view, i % h->width, i / h->width);
    ((float *)(void *)(memory + plane(h, 0)))[i] = p.depth;
    stage_normal(h, 1, i, p.stored_normal);
    stage_normal(h, HOST_GEOMETRIC_NORMAL, i, p.geometric_normal);
    stage_normal(h, HOST_VERTEX_NORMAL, i, p.vertex_normal);
    ((uint32_t *)(void *)(memory + plane(h, HOST_DYNAMIC)))[i] = p.dynamic ? 255u : 0u;
    ((uint32_t *)(void *)(memory + plane(h, 2)))[i] = unorm(p.color);
    ((uint32_t *)(void *)(memory + plane(h, 3)))[i] = unorm(olx_v3(p.roughness, p.metallic, p.weight));
  }
  for (uint32_t i = 0; i < HOST_INPUTS; i++) {
    const VkBufferImageCopy region = whole_image(h, plane(h, i));
    gpu_image_barrier(device, device->commands, &h->inputs[i], VK_IMAGE_LAYOUT_UNDEFINED,
                      VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
    device->CmdCopyBufferToImage(device->commands, h->staging.buffer, h->inputs[i].image,
                                 VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &region);
    gpu_image_barrier(device, device->commands, &h->inputs[i], VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                      VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL);
  }
  const VkClearColorValue color = {.float32 = {HOST_BEFORE.x, HOST_BEFORE.y, HOST_BEFORE.z, 1.0f}};
  const VkImageSubresourceRange range = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
  for (uint32_t i = 0; i < HOST_OUTPUTS; i++) {
    gpu_image_barrier(device, device->commands, &h->outputs[i], VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_GENERAL);
    device->CmdClearColorImage(device->commands, h->outputs[i].image, VK_IMAGE_LAYOUT_GENERAL, &color, 1, &range);
  }
  gpu_full_barrier(device, device->commands);
}

void host_download(host_images *h) {
  gpu_device *device = h->device;
  for (uint32_t i = 0; i < HOST_OUTPUTS; i++) {
    const VkBufferImageCopy region = whole_image(h, plane(h, i));
    gpu_image_barrier(device, device->commands, &h->outputs[i], VK_IMAGE_LAYOUT_GENERAL,
                      VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
    device->CmdCopyImageToBuffer(device->commands, h->outputs[i].image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                                 h->staging.buffer, 1, &region);
  }
  gpu_full_barrier(device, device->commands);
}

olx_vec3 host_output(const host_images *h, uint32_t image, uint32_t i, float *alpha) {
  uint16_t half[4];
  memcpy(half, (const char *)h->staging.mapped + plane(h, image) + (size_t)8 * i, sizeof half);
  *alpha = olx_half_unpack(half[3]);
  return olx_v3(olx_half_unpack(half[0]), olx_half_unpack(half[1]), olx_half_unpack(half[2]));
}

const analytic_scene HOST_ROOM = {
    .room = {{0, 0, 0}, {4, 3, 5}}, .box_count = 1, .boxes = {{{0.9f, 0.0f, 1.1f}, {1.7f, 1.3f, 2.1f}}}};

olx_field *host_field_make(uint32_t size, uint32_t irradiance_size) {
  static const olx_grid grid = {{0.5f, 0.5f, 0.5f}, {3.0f, 2.0f, 4.0f}, {2, 2, 2}};
  return analytic_field_make(&HOST_ROOM, &grid, size, irradiance_size);
}

host_fixture host_fixture_make(gpu_device *device, uint32_t size, uint32_t irradiance_size) {
  host_need_device(device);
  host_fixture f = {.device = device, .messages = device->validation_messages};
  f.field = host_field_make(size, irradiance_size);
  if (olx_vulkan_field_create(&device->host, f.field, &f.uploaded) != OLX_OK) fail_msg("%s", olx_last_error());
  return f;
}

void host_fixture_add_frame(host_fixture *f) {
  if (olx_vulkan_frame_create(f->uploaded, &f->images.targets, &f->frame) != OLX_OK) fail_msg("%s", olx_last_error());
}

void host_fixture_free(host_fixture *f) {
  olx_vulkan_frame_destroy(f->frame);
  if (f->images.device) host_images_free(&f->images);
  olx_vulkan_field_destroy(f->uploaded);
  analytic_field_free(f->field);
  assert_int_equal(f->device->validation_messages, f->messages);
}
