// Records the pass that tone-maps linear radiance to the displayed image.
#include "tone_pass.h"

static const uint32_t SHADER[] = {
#include "tone_map.spv.inc"
};

enum { LIGHT, DISPLAY, BINDINGS };

static const VkDescriptorType TYPES[BINDINGS] = {VK_DESCRIPTOR_TYPE_STORAGE_IMAGE, VK_DESCRIPTOR_TYPE_STORAGE_IMAGE};

// Push constants, with the layout of shaders/tone_map.comp.
typedef struct tone_constants {
  float exposure;
  uint32_t width, height;
} tone_constants;

bool tone_pass_create(gpu_device *d, tone_pass *pass) {
  *pass = (tone_pass){.set = {.set = VK_NULL_HANDLE}};
  if (gpu_set_create(d, "descriptors for the tone map", TYPES, BINDINGS, VK_SHADER_STAGE_COMPUTE_BIT, &pass->set) &&
      gpu_compute_create(d, "the tone map's pipeline", GPU_CODE(SHADER), &pass->set.layout, 1, sizeof(tone_constants),
                         &pass->compute)) {
    return true;
  }
  tone_pass_destroy(d, pass);
  return false;
}

void tone_pass_destroy(gpu_device *d, tone_pass *pass) {
  gpu_compute_destroy(d, &pass->compute);
  gpu_set_destroy(d, &pass->set);
}

void tone_pass_attach(gpu_device *d, tone_pass *pass, const frame_images *images, frame_image shown) {
  const gpu_binding bindings[BINDINGS] = {
      {.type = VK_DESCRIPTOR_TYPE_STORAGE_IMAGE, .view = images->images[shown].view, .layout = VK_IMAGE_LAYOUT_GENERAL},
      {.type = VK_DESCRIPTOR_TYPE_STORAGE_IMAGE,
       .view = images->images[FRAME_DISPLAY].view,
       .layout = VK_IMAGE_LAYOUT_GENERAL}};
  gpu_set_write(d, &pass->set, bindings, BINDINGS);
}

void tone_pass_record(const gpu_device *d, const tone_pass *pass, VkCommandBuffer commands, const frame_images *images,
                      float exposure) {
  const tone_constants constants = {exposure, images->width, images->height};
  const VkPipelineStageFlags uses = VK_PIPELINE_STAGE_TRANSFER_BIT | VK_PIPELINE_STAGE_FRAGMENT_SHADER_BIT |
                                    VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT;
  gpu_memory_barrier(d, commands, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT | uses,
                     VK_ACCESS_SHADER_WRITE_BIT | VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT,
                     VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT);
  gpu_compute_record(d, &pass->compute, &pass->set.set, 1, &constants, sizeof constants, images->width, images->height,
                     commands);
  gpu_memory_barrier(d, commands, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_ACCESS_SHADER_WRITE_BIT,
                     VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT | uses,
                     VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_TRANSFER_READ_BIT | VK_ACCESS_COLOR_ATTACHMENT_READ_BIT |
                         VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT);
}
