// Meters the brightness of the image on the device, and adapts the exposure within half a second, like an eye.
#include "view_meter.h"

#include <math.h>

static const uint32_t SHADER[] = {
#include "view_meter.spv.inc"
};

enum { LIGHT, METERED, BINDINGS };
// The mean is exposed like a grey card.
static const float GREY = 0.18f, SECONDS = 0.5f, LEAST = 1e-3f, MOST = 1e3f;

static const VkDescriptorType TYPES[BINDINGS] = {VK_DESCRIPTOR_TYPE_STORAGE_IMAGE, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER};

// The result, with the layout of shaders/view_meter.comp.
typedef struct metered {
  float log_sum, count;
} metered;

bool view_meter_create(gpu_device *d, view_meter *meter) {
  *meter = (view_meter){.set = {.set = VK_NULL_HANDLE}};
  if (!gpu_buffer_create(d, "the meter", sizeof(metered), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, true, &meter->metered))
    return false;
  *(metered *)meter->metered.mapped = (metered){0.0f, 0.0f};
  if (gpu_set_create(d, "descriptors for the meter", TYPES, BINDINGS, VK_SHADER_STAGE_COMPUTE_BIT, &meter->set) &&
      gpu_compute_create(d, "the meter's pipeline", GPU_CODE(SHADER), &meter->set.layout, 1, sizeof(uint32_t),
                         &meter->compute))
    return true;
  view_meter_destroy(d, meter);
  return false;
}

void view_meter_destroy(gpu_device *d, view_meter *meter) {
  gpu_compute_destroy(d, &meter->compute);
  gpu_set_destroy(d, &meter->set);
  gpu_buffer_destroy(d, &meter->metered);
}

void view_meter_attach(gpu_device *d, view_meter *meter, const frame_images *images) {
  const gpu_binding bindings[BINDINGS] = {
      [LIGHT] = {.type = VK_DESCRIPTOR_TYPE_STORAGE_IMAGE,
                 .view = images->images[FRAME_COLOR].view,
                 .layout = VK_IMAGE_LAYOUT_GENERAL},
      [METERED] = {.type = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, .buffer = &meter->metered}};
  gpu_set_write(d, &meter->set, bindings, BINDINGS);
}

void view_meter_record(const gpu_device *d, const view_meter *meter, VkCommandBuffer commands) {
  gpu_memory_barrier(d, commands, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT,
                     VK_ACCESS_SHADER_WRITE_BIT | VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT,
                     VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_ACCESS_SHADER_READ_BIT);
  const uint32_t nothing = 0;
  gpu_compute_record(d, &meter->compute, &meter->set.set, 1, &nothing, sizeof nothing, 8, 8, commands); // one workgroup
  gpu_memory_barrier(d, commands, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_ACCESS_SHADER_WRITE_BIT,
                     VK_PIPELINE_STAGE_HOST_BIT, VK_ACCESS_HOST_READ_BIT);
}

float view_meter_follow(const view_meter *meter, float exposure, float seconds) {
  const metered *m = meter->metered.mapped;
  if (!(m->count > 0.0f) || !isfinite(m->log_sum)) return exposure;
  const float wanted = log2f(GREY) - m->log_sum / m->count, now = log2f(exposure);
  const float share = 1.0f - expf(-seconds / SECONDS);
  return fminf(fmaxf(exp2f(now + share * (wanted - now)), LEAST), MOST);
}
