// Renders a small room by a field on the device, and compares its light with the CPU's light from a field, for tests of
// relighting.
#include "relit_room.h"

#include "core/bsdf.h"
#include "core/sampling.h"

enum { WIDTH = 52, HEIGHT = 36, PIXELS = WIDTH * HEIGHT };

static const analytic_scene ROOM = {.room = {{-1, -1, -1}, {1, 1, 1}}};
static const host_view VIEW = {.scene = &ROOM, .eye = {0.3f, 0.2f, 0.8f}, .width = WIDTH, .height = HEIGHT};

relit_room relit_room_make(gpu_device *device, const olx_field *field) {
  relit_room room = {.images = host_images_make(device, WIDTH, HEIGHT, VK_FORMAT_R32G32B32A32_SFLOAT)};
  room.images.targets.passes = OLX_VULKAN_PASS_IRRADIANCE | OLX_VULKAN_PASS_GLOSSY;
  ASSERT_OK(olx_vulkan_field_create(&device->host, field, &room.uploaded));
  ASSERT_OK(olx_vulkan_frame_create(room.uploaded, &room.images.targets, &room.frame));
  return room;
}

void relit_room_free(relit_room *room) {
  olx_vulkan_frame_destroy(room->frame);
  host_images_free(&room->images);
  olx_vulkan_field_destroy(room->uploaded);
}

void relit_room_render(relit_room *room) {
  gpu_device *device = room->images.device;
  const olx_vulkan_view view = host_vulkan_view(&VIEW);
  const olx_vulkan_settings settings = olx_vulkan_settings_default();
  assert_true(gpu_commands_begin(device));
  host_upload(&room->images, &VIEW);
  ASSERT_OK(olx_vulkan_record_irradiance(room->frame, device->commands, &view, &settings));
  ASSERT_OK(olx_vulkan_record_glossy(room->frame, device->commands, &view, &settings));
  host_download(&room->images);
  assert_true(gpu_commands_run(device));
}

static olx_vec3 glossy_light(const olx_field *lit, const host_pixel *p, uint32_t x, uint32_t y) {
  const olx_sample_settings sample = olx_sample_settings_default();
  const float metallic = floorf(p->metallic * 255.0f + 0.5f) / 255.0f, w = floorf(p->weight * 255.0f + 0.5f) / 255.0f;
  const olx_vec3 color =
      olx_v3(floorf(p->color.x * 255.0f + 0.5f) / 255.0f, floorf(p->color.y * 255.0f + 0.5f) / 255.0f,
             floorf(p->color.z * 255.0f + 0.5f) / 255.0f);
  const olx_bsdf bsdf = olx_bsdf_make(color, metallic, p->roughness, w);
  float weight, half_cosine;
  const olx_vec2 random = olx_stratified2(0, olx_hash2(olx_hash2(x, y), OLX_SALT_BRANCH + OLX_GLOSSY_BRANCH));
  const olx_vec3 radiance =
      olx_glossy(lit, &sample, p->position, p->normal, p->view, p->roughness, random, &weight, &half_cosine, NULL);
  return weight > 0.0f ? olx_scale(olx_mul(olx_fresnel(&bsdf, half_cosine), radiance), weight) : olx_splat(0.0f);
}

void relit_room_judge(const relit_room *room, const olx_field *lit, double errors[2]) {
  const olx_sample_settings sample = olx_sample_settings_default();
  double off[2] = {0}, sum[2] = {0};
  for (uint32_t i = 0; i < PIXELS; i++) {
    const host_pixel p = host_pixel_at(&VIEW, i % WIDTH, i / WIDTH);
    if (p.empty) continue;
    const olx_vec3 truth[2] = {olx_surface_irradiance(lit, &sample, p.position, p.normal, p.normal, p.view),
                               glossy_light(lit, &p, i % WIDTH, i / WIDTH)};
    for (uint32_t k = 0; k < 2; k++) {
      float alpha;
      const olx_vec3 d = olx_sub(host_output(&room->images, k, i, &alpha), truth[k]);
      off[k] += (double)olx_dot(d, d);
      sum[k] += (double)olx_dot(truth[k], truth[k]);
    }
  }
  for (uint32_t k = 0; k < 2; k++) errors[k] = sum[k] > 0.0 ? off[k] / sum[k] : off[k];
}
