// Creates the images of a frame and keeps them in the layouts that passes expect: the G-buffer, Octalux's outputs, and
// the displayed image.
#include "frame_images.h"

static const struct {
  const char *what;
  VkFormat format;
  VkImageUsageFlags usage;
} IMAGES[FRAME_IMAGES] = {
#define DRAWN VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT
#define COMPUTED VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT
    [FRAME_NORMAL] = {"the image of normals", VK_FORMAT_R16G16B16A16_SFLOAT, DRAWN},
    [FRAME_ALBEDO] = {"the image of albedos", VK_FORMAT_R8G8B8A8_SRGB, DRAWN},
    [FRAME_MATERIAL] = {"the image of materials", VK_FORMAT_R8G8B8A8_UNORM, DRAWN},
    [FRAME_VERTEX_NORMAL] = {"the image of vertex normals", VK_FORMAT_R16G16B16A16_SFLOAT, DRAWN},
    [FRAME_COLOR] = {"the image of colors", VK_FORMAT_R16G16B16A16_SFLOAT, DRAWN | COMPUTED},
    [FRAME_DEPTH] = {"the image of depths", VK_FORMAT_D32_SFLOAT,
                     VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT |
                         VK_IMAGE_USAGE_TRANSFER_SRC_BIT},
    [FRAME_IRRADIANCE] = {"the image of irradiances", VK_FORMAT_R16G16B16A16_SFLOAT, COMPUTED},
    [FRAME_GLOSSY] = {"the image of glossy light", VK_FORMAT_R16G16B16A16_SFLOAT, COMPUTED},
    [FRAME_DISPLAY] = {"the picture", VK_FORMAT_R8G8B8A8_UNORM, DRAWN | COMPUTED},
#undef DRAWN
#undef COMPUTED
};

VkFormat frame_image_format(frame_image image) { return IMAGES[image].format; }

static VkImageLayout resting_layout(uint32_t image) {
  if (image == FRAME_DEPTH) return VK_IMAGE_LAYOUT_DEPTH_STENCIL_READ_ONLY_OPTIMAL;
  return image < FRAME_COLOR ? VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL : VK_IMAGE_LAYOUT_GENERAL;
}

static bool create_moved(gpu_device *d, frame_images *images) {
  const VkImageViewCreateInfo info = {.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
                                      .image = images->images[FRAME_MATERIAL].image,
                                      .viewType = VK_IMAGE_VIEW_TYPE_2D,
                                      .format = IMAGES[FRAME_MATERIAL].format,
                                      .components = {.r = VK_COMPONENT_SWIZZLE_A},
                                      .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1}};
  return gpu_check(d, d->CreateImageView(d->host.device, &info, NULL, &images->moved), "a view of moved objects");
}

bool frame_images_create(gpu_device *d, uint32_t width, uint32_t height, frame_images *images) {
  *images = (frame_images){.width = width, .height = height};
  bool fine = true;
  for (uint32_t i = 0; i < FRAME_IMAGES && fine; i++) {
    const gpu_image_info info = {
        .what = IMAGES[i].what, .format = IMAGES[i].format, .width = width, .height = height, .usage = IMAGES[i].usage};
    fine = gpu_image_create(d, &info, &images->images[i]);
  }
  fine = fine && create_moved(d, images) && gpu_commands_begin(d);
  for (uint32_t i = 0; i < FRAME_IMAGES && fine; i++) {
    gpu_image_barrier(d, d->commands, &images->images[i], VK_IMAGE_LAYOUT_UNDEFINED, resting_layout(i));
  }
  fine = fine && gpu_commands_run(d);
  if (!fine) frame_images_destroy(d, images);
  return fine;
}

void frame_images_destroy(gpu_device *d, frame_images *images) {
  if (images->moved) d->DestroyImageView(d->host.device, images->moved, NULL);
  for (uint32_t i = 0; i < FRAME_IMAGES; i++) gpu_image_destroy(d, &images->images[i]);
  *images = (frame_images){.width = 0};
}

olx_vulkan_targets frame_images_targets(const frame_images *images) {
  olx_vulkan_image inputs[FRAME_DRAWN];
  for (uint32_t i = 0; i < FRAME_DRAWN; i++) {
    inputs[i] = (olx_vulkan_image){images->images[i].view, images->images[i].format, resting_layout(i)};
  }
  return (olx_vulkan_targets){.width = images->width,
                              .height = images->height,
                              .depth = inputs[FRAME_DEPTH],
                              .normal = inputs[FRAME_NORMAL],
                              .albedo = inputs[FRAME_ALBEDO],
                              .roughness = inputs[FRAME_MATERIAL],
                              .vertex_normal = inputs[FRAME_VERTEX_NORMAL],
                              .dynamic = {images->moved, IMAGES[FRAME_MATERIAL].format, resting_layout(FRAME_MATERIAL)},
                              .irradiance = images->images[FRAME_IRRADIANCE].view,
                              .glossy = images->images[FRAME_GLOSSY].view,
                              .color = images->images[FRAME_COLOR].view};
}
