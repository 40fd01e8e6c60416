// Records the pass that adds direct light of lamps, with shadows from maps, and the environment behind all surfaces.
#include "direct_pass.h"

#include <stdlib.h>
#include <string.h>

static const uint32_t SHADER[] = {
#include "direct_light.spv.inc"
};

enum { DEPTH, NORMAL, ALBEDO, MATERIAL, COLOR, LAMPS, VIEWS, MAPS, SKY, ENVIRONMENT, BINDINGS };

static const VkDescriptorType TYPES[BINDINGS] = {
    [DEPTH] = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER,  [NORMAL] = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER,
    [ALBEDO] = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, [MATERIAL] = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER,
    [COLOR] = VK_DESCRIPTOR_TYPE_STORAGE_IMAGE,           [LAMPS] = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
    [VIEWS] = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,          [MAPS] = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER,
    [SKY] = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER,    [ENVIRONMENT] = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
};

// Laid out as shaders/direct_light.comp declares it.
typedef struct sky_constants {
  float radiance[3], rotation_radians;
  uint32_t has_image, lamp_count, unused[2];
} sky_constants;

typedef struct direct_constants {
  float clip_to_world[16];
  float eye[3];
  uint32_t add;
  uint32_t width, height;
} direct_constants;

static bool upload_sky(gpu_device *d, const olx_environment *e, direct_pass *pass) {
  const uint32_t width = e->texels ? e->width : 1, height = e->texels ? e->height : 1;
  const gpu_image_info info = {.what = "the sky",
                               .format = VK_FORMAT_R32G32B32A32_SFLOAT,
                               .width = width,
                               .height = height,
                               .usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT};
  const size_t texels = (size_t)width * height;
  gpu_buffer staging;
  if (!gpu_image_create(d, &info, &pass->sky)) return false;
  if (!gpu_buffer_create(d, "the sky's staging", 16 * texels, VK_BUFFER_USAGE_TRANSFER_SRC_BIT, true, &staging))
    return false;
  float *to = staging.mapped;
  for (size_t i = 0; i < texels; i++) {
    for (size_t k = 0; k < 3; k++) to[4 * i + k] = e->texels ? e->texels[3 * i + k] : 1.0f;
    to[4 * i + 3] = 1.0f;
  }
  const bool fine = gpu_image_write(d, &pass->sky, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL, &staging);
  gpu_buffer_destroy(d, &staging);
  return fine;
}

static bool upload_environment(gpu_device *d, const olx_environment *e, uint32_t lamp_count, direct_pass *pass) {
  const sky_constants sky = {.radiance = {e->radiance.x, e->radiance.y, e->radiance.z},
                             .rotation_radians = e->rotation_radians,
                             .has_image = e->texels != NULL,
                             .lamp_count = lamp_count};
  return gpu_buffer_upload(d, "the environment", &sky, sizeof sky, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT,
                           &pass->environment);
}

static bool create_samplers(gpu_device *d, direct_pass *pass) {
  VkFormatProperties depth;
  d->GetPhysicalDeviceFormatProperties(d->host.physical_device, VK_FORMAT_D32_SFLOAT, &depth);
  const bool filtered = depth.optimalTilingFeatures & VK_FORMAT_FEATURE_SAMPLED_IMAGE_FILTER_LINEAR_BIT;
  const VkFilter filter = filtered ? VK_FILTER_LINEAR : VK_FILTER_NEAREST;
  const VkSamplerCreateInfo shadow = {.sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO,
                                      .magFilter = filter,
                                      .minFilter = filter,
                                      .addressModeU = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
                                      .addressModeV = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
                                      .compareEnable = VK_TRUE,
                                      .compareOp = VK_COMPARE_OP_GREATER_OR_EQUAL};
  const VkSamplerCreateInfo plain = {.sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO};
  return gpu_check(d, d->CreateSampler(d->host.device, &shadow, NULL, &pass->shadow_sampler), "a sampler") &&
         gpu_check(d, d->CreateSampler(d->host.device, &plain, NULL, &pass->plain_sampler), "a sampler");
}

bool direct_pass_create(gpu_device *d, const olx_scene_content *content, const shadow_pass *shadows,
                        direct_pass *pass) {
  *pass = (direct_pass){.shadows = shadows};
  if (upload_sky(d, content->environment, pass) &&
      upload_environment(d, content->environment, shadows->lamp_count, pass) && create_samplers(d, pass) &&
      gpu_set_create(d, "descriptors for direct light", TYPES, BINDINGS, VK_SHADER_STAGE_COMPUTE_BIT, &pass->set) &&
      gpu_compute_create(d, "the pipeline of direct light", GPU_CODE(SHADER), &pass->set.layout, 1,
                         sizeof(direct_constants), &pass->compute)) {
    return true;
  }
  direct_pass_destroy(d, pass);
  return false;
}

void direct_pass_destroy(gpu_device *d, direct_pass *pass) {
  gpu_compute_destroy(d, &pass->compute);
  gpu_set_destroy(d, &pass->set);
  if (pass->shadow_sampler) d->DestroySampler(d->host.device, pass->shadow_sampler, NULL);
  if (pass->plain_sampler) d->DestroySampler(d->host.device, pass->plain_sampler, NULL);
  gpu_buffer_destroy(d, &pass->environment);
  gpu_image_destroy(d, &pass->sky);
  *pass = (direct_pass){.shadows = NULL};
}

static gpu_binding image_binding(VkImageView view, VkSampler sampler, VkImageLayout layout) {
  return (gpu_binding){
      .type = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, .view = view, .sampler = sampler, .layout = layout};
}

void direct_pass_attach(gpu_device *d, direct_pass *pass, const frame_images *images) {
  const gpu_image *of = images->images;
  const VkImageLayout read = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL;
  const VkImageLayout depth_read = VK_IMAGE_LAYOUT_DEPTH_STENCIL_READ_ONLY_OPTIMAL;
  const VkSampler plain = pass->plain_sampler;
  const VkDescriptorType buffer = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
  const gpu_binding bindings[BINDINGS] = {
      [DEPTH] = image_binding(of[FRAME_DEPTH].view, plain, depth_read),
      [NORMAL] = image_binding(of[FRAME_NORMAL].view, plain, read),
      [ALBEDO] = image_binding(of[FRAME_ALBEDO].view, plain, read),
      [MATERIAL] = image_binding(of[FRAME_MATERIAL].view, plain, read),
      [COLOR] = {.type = VK_DESCRIPTOR_TYPE_STORAGE_IMAGE,
                 .view = of[FRAME_COLOR].view,
                 .layout = VK_IMAGE_LAYOUT_GENERAL},
      [LAMPS] = {.type = buffer, .buffer = &pass->shadows->lamps},
      [VIEWS] = {.type = buffer, .buffer = &pass->shadows->matrices},
      [MAPS] = image_binding(pass->shadows->maps.view, pass->shadow_sampler, depth_read),
      [SKY] = image_binding(pass->sky.view, plain, read),
      [ENVIRONMENT] = {.type = buffer, .buffer = &pass->environment},
  };
  gpu_set_write(d, &pass->set, bindings, BINDINGS);
}

void direct_pass_record(const gpu_device *d, const direct_pass *pass, VkCommandBuffer commands,
                        const frame_images *images, const raster_view *view, uint32_t add) {
  direct_constants constants = {.eye = {view->lit.eye.x, view->lit.eye.y, view->lit.eye.z},
                                .add = add,
                                .width = images->width,
                                .height = images->height};
  memcpy(constants.clip_to_world, view->lit.clip_to_world, sizeof constants.clip_to_world);
  gpu_compute_record(d, &pass->compute, &pass->set.set, 1, &constants, sizeof constants, images->width, images->height,
                     commands);
  gpu_memory_barrier(d, commands, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_ACCESS_SHADER_WRITE_BIT,
                     VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT);
}
