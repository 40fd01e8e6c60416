// Creates the pipelines and descriptor sets of a frame's denoiser, and binds the history and the host's images to them.
#include "vulkan/vulkan_frame.h"

enum {
  ACCUMULATE_STORAGE = OLX_BINDING_GUIDE_NOW,
  FILTER_STORAGE = OLX_BINDING_OUT_ROWS,
  SAMPLED = 2 * ACCUMULATE_STORAGE + 4 * FILTER_STORAGE,
  STORED = 2 * (OLX_ACCUMULATE_BINDINGS - ACCUMULATE_STORAGE) + 4 * (OLX_FILTER_BINDINGS - FILTER_STORAGE)
};

olx_result olx_gpu_denoiser_create(olx_vulkan_frame *f) {
  const olx_vulkan_context *c = &f->field->context;
  olx_gpu_denoiser *d = &f->denoiser;
  OLX_TRY(olx_gpu_set_layout_create(c, OLX_ACCUMULATE_BINDINGS, ACCUMULATE_STORAGE, &d->accumulate_set_layout));
  OLX_TRY(olx_gpu_set_layout_create(c, OLX_FILTER_BINDINGS, FILTER_STORAGE, &d->filter_set_layout));
  OLX_TRY(
      olx_gpu_layout_create(c, 1, &d->accumulate_set_layout, sizeof(olx_accumulate_constants), &d->accumulate_layout));
  OLX_TRY(olx_gpu_layout_create(c, 1, &d->filter_set_layout, sizeof(olx_filter_constants), &d->filter_layout));
  OLX_TRY(olx_gpu_pipeline_create(c, &olx_accumulate_pass, NULL, d->accumulate_layout, &d->accumulate));
  OLX_TRY(olx_gpu_pipeline_create(c, &olx_filter_pass, NULL, d->filter_layout, &d->filter));
  OLX_TRY(olx_gpu_pool_create(c, 6, SAMPLED, STORED, &d->pool));
  for (uint32_t i = 0; i < 2; i++) {
    OLX_TRY(olx_gpu_set_allocate(c, d->pool, d->accumulate_set_layout, &d->accumulate_sets[i]));
    for (uint32_t lobe = 0; lobe < 2; lobe++) {
      OLX_TRY(olx_gpu_set_allocate(c, d->pool, d->filter_set_layout, &d->filter_sets[lobe][i]));
    }
  }
  return OLX_OK;
}

void olx_gpu_denoiser_destroy(olx_vulkan_frame *f) {
  const olx_vulkan_functions *vk = &f->field->context.vk;
  const VkDevice device = f->field->context.host.device;
  olx_gpu_denoiser *d = &f->denoiser;
  vk->DestroyDescriptorPool(device, d->pool, NULL);
  vk->DestroyPipeline(device, d->accumulate, NULL);
  vk->DestroyPipeline(device, d->filter, NULL);
  vk->DestroyPipelineLayout(device, d->accumulate_layout, NULL);
  vk->DestroyPipelineLayout(device, d->filter_layout, NULL);
  vk->DestroyDescriptorSetLayout(device, d->accumulate_set_layout, NULL);
  vk->DestroyDescriptorSetLayout(device, d->filter_set_layout, NULL);
  *d = (olx_gpu_denoiser){.filter = VK_NULL_HANDLE};
}

static VkDescriptorImageInfo host_image(const olx_vulkan_frame *f, const olx_vulkan_image *image) {
  return (VkDescriptorImageInfo){f->field->nearest, image->view, image->layout};
}

// Returns an image of the history. A lobe without images gets the other lobe's, which are bound but not read.
static VkDescriptorImageInfo history_image(const olx_vulkan_frame *f, uint32_t kind, uint32_t i) {
  const uint32_t other = kind == OLX_HISTORY_DIFFUSE ? OLX_HISTORY_GLOSSY : OLX_HISTORY_DIFFUSE;
  const VkImageView view = f->history.views[olx_gpu_history_has(&f->history, kind) ? kind : other][i];
  return (VkDescriptorImageInfo){f->field->nearest, view, VK_IMAGE_LAYOUT_GENERAL};
}

static void write_accumulate_set(olx_vulkan_frame *f, const olx_vulkan_targets *t, uint32_t now) {
  const uint32_t before = now ^ 1u;
  const VkDescriptorImageInfo images[OLX_ACCUMULATE_BINDINGS] = {
      [OLX_BINDING_DENOISE_DEPTH] = host_image(f, &t->depth),
      [OLX_BINDING_DENOISE_NORMAL] = host_image(f, &t->normal),
      [OLX_BINDING_DENOISE_ROUGHNESS] = host_image(f, &t->roughness),
      [OLX_BINDING_GUIDE_BEFORE] = history_image(f, OLX_HISTORY_GUIDE, before),
      [OLX_BINDING_DIFFUSE_BEFORE] = history_image(f, OLX_HISTORY_DIFFUSE, before),
      [OLX_BINDING_GLOSSY_BEFORE] = history_image(f, OLX_HISTORY_GLOSSY, before),
      [OLX_BINDING_GUIDE_NOW] = history_image(f, OLX_HISTORY_GUIDE, now),
      [OLX_BINDING_DIFFUSE_NOW] = history_image(f, OLX_HISTORY_DIFFUSE, now),
      [OLX_BINDING_GLOSSY_NOW] = history_image(f, OLX_HISTORY_GLOSSY, now),
  };
  olx_gpu_set_write(&f->field->context, f->denoiser.accumulate_sets[now], OLX_ACCUMULATE_BINDINGS, ACCUMULATE_STORAGE,
                    images);
}

static void write_filter_set(olx_vulkan_frame *f, const olx_vulkan_targets *t, uint32_t lobe, uint32_t now) {
  const uint32_t kind = lobe ? OLX_HISTORY_GLOSSY : OLX_HISTORY_DIFFUSE, before = now ^ 1u;
  const VkDescriptorImageInfo images[OLX_FILTER_BINDINGS] = {
      [OLX_BINDING_GUIDE] = history_image(f, OLX_HISTORY_GUIDE, now),
      [OLX_BINDING_LIGHT] = history_image(f, kind, now),
      // The history of the previous frame is no longer needed.
      [OLX_BINDING_ROWS] = history_image(f, kind, before),
      [OLX_BINDING_FILTER_ALBEDO] = host_image(f, &t->albedo),
      [OLX_BINDING_FILTER_ROUGHNESS] = host_image(f, &t->roughness),
      [OLX_BINDING_OUT_ROWS] = history_image(f, kind, before),
      [OLX_BINDING_OUT_TARGET] = {VK_NULL_HANDLE, lobe ? t->glossy : t->irradiance, VK_IMAGE_LAYOUT_GENERAL},
  };
  olx_gpu_set_write(&f->field->context, f->denoiser.filter_sets[lobe][now], OLX_FILTER_BINDINGS, FILTER_STORAGE,
                    images);
}

void olx_gpu_denoiser_write(olx_vulkan_frame *f, const olx_vulkan_targets *t) {
  for (uint32_t now = 0; now < 2; now++) {
    write_accumulate_set(f, t, now);
    for (uint32_t lobe = 0; lobe < 2; lobe++) write_filter_set(f, t, lobe, now);
  }
}
