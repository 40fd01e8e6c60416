// Runs the passes and copies that the benchmark compares with: a pass that counts reads, a pass with the least possible
// work, and plain copies.
#include "bench_probe.h"

#include <string.h>

static const uint32_t COUNTS_SHADER[] = {
#include "bench_counts.spv.inc"
};
static const uint32_t FLOOR_SHADER[] = {
#include "bench_floor.spv.inc"
};

enum { DEPTH, NORMAL, ALBEDO, MATERIAL, INPUTS, RESULT = INPUTS, BINDINGS };

// Push constants, with the layout of shaders/bench_surface.glsl.
typedef struct probe_constants {
  float clip_to_world[16];
  float eye[3];
  uint32_t width, height, stride;
  uint32_t tracer, select, kind;
} probe_constants;

// Counts per pixel, with the layout of shaders/bench_counts.comp.
typedef struct pixel_counts {
  uint32_t filtered, fetched, steps, probes;
  uint32_t surface, ray, unknown, texels;
  float light;
} pixel_counts;

static bool create_set(gpu_device *d, const rasteriser *raster, VkSampler sampler, const gpu_binding *result,
                       gpu_set *set) {
  static const frame_image inputs[INPUTS] = {FRAME_DEPTH, FRAME_NORMAL, FRAME_ALBEDO, FRAME_MATERIAL};
  gpu_binding bindings[BINDINGS];
  VkDescriptorType types[BINDINGS];
  for (uint32_t i = 0; i < INPUTS; i++) {
    bindings[i] = (gpu_binding){.type = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER,
                                .view = raster->images.images[inputs[i]].view,
                                .sampler = sampler,
                                .layout = i == DEPTH ? VK_IMAGE_LAYOUT_DEPTH_STENCIL_READ_ONLY_OPTIMAL
                                                     : VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL};
  }
  bindings[RESULT] = *result;
  for (uint32_t i = 0; i < BINDINGS; i++) types[i] = bindings[i].type;
  if (!gpu_set_create(d, "the benchmark's descriptors", types, BINDINGS, VK_SHADER_STAGE_COMPUTE_BIT, set))
    return false;
  gpu_set_write(d, set, bindings, BINDINGS);
  return true;
}

static bool create_pipeline(gpu_device *d, gpu_code code, VkDescriptorSetLayout field, VkDescriptorSetLayout own,
                            gpu_compute *compute) {
  const VkDescriptorSetLayout sets[2] = {field, own};
  return gpu_compute_create(d, "the benchmark's pipelines", code, sets, 2, sizeof(probe_constants), compute);
}

bool bench_probe_create(gpu_device *d, const olx_vulkan_field *field, const rasteriser *raster, bench_probe *probe) {
  *probe = (bench_probe){.sampler = VK_NULL_HANDLE};
  const VkDeviceSize bytes = (VkDeviceSize)raster->images.width * raster->images.height * sizeof(pixel_counts);
  const VkSamplerCreateInfo plain = {.sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO};
  const VkDescriptorSetLayout layout = olx_vulkan_field_set_layout(field);
  bool fine = gpu_check(d, d->CreateSampler(d->host.device, &plain, NULL, &probe->sampler), "a sampler") &&
              gpu_buffer_create(d, "the counts", bytes, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, true, &probe->counted);
  if (fine) {
    const gpu_binding counted = {.type = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, .buffer = &probe->counted};
    const gpu_binding light = {.type = VK_DESCRIPTOR_TYPE_STORAGE_IMAGE,
                               .view = raster->images.images[FRAME_IRRADIANCE].view,
                               .layout = VK_IMAGE_LAYOUT_GENERAL};
    fine = create_set(d, raster, probe->sampler, &counted, &probe->counts_set) &&
           create_set(d, raster, probe->sampler, &light, &probe->floor_set) &&
           create_pipeline(d, GPU_CODE(COUNTS_SHADER), layout, probe->counts_set.layout, &probe->counts) &&
           create_pipeline(d, GPU_CODE(FLOOR_SHADER), layout, probe->floor_set.layout, &probe->floor);
  }
  if (!fine) bench_probe_destroy(d, probe);
  return fine;
}

void bench_probe_destroy(gpu_device *d, bench_probe *probe) {
  gpu_compute_destroy(d, &probe->counts);
  gpu_compute_destroy(d, &probe->floor);
  gpu_set_destroy(d, &probe->counts_set);
  gpu_set_destroy(d, &probe->floor_set);
  gpu_buffer_destroy(d, &probe->counted);
  if (probe->sampler) d->DestroySampler(d->host.device, probe->sampler, NULL);
  *probe = (bench_probe){.sampler = VK_NULL_HANDLE};
}

static void dispatch(const gpu_device *d, const gpu_compute *compute, const olx_vulkan_field *field, const gpu_set *set,
                     const rasteriser *raster, const raster_view *view, probe_constants *constants,
                     VkCommandBuffer commands) {
  memcpy(constants->clip_to_world, view->lit.clip_to_world, sizeof constants->clip_to_world);
  constants->eye[0] = view->lit.eye.x;
  constants->eye[1] = view->lit.eye.y;
  constants->eye[2] = view->lit.eye.z;
  constants->width = raster->images.width;
  constants->height = raster->images.height;
  const VkDescriptorSet sets[2] = {olx_vulkan_field_set(field), set->set};
  gpu_compute_record(d, compute, sets, 2, constants, sizeof *constants,
                     (constants->width + constants->stride - 1) / constants->stride,
                     (constants->height + constants->stride - 1) / constants->stride, commands);
}

static void sum_counts(const pixel_counts *pixels, uint32_t count, bench_counts *sums) {
  *sums = (bench_counts){.filtered = 0.0};
  for (uint32_t i = 0; i < count; i++) {
    const pixel_counts *p = &pixels[i];
    sums->filtered += p->filtered;
    if (p->filtered > sums->most_filtered) sums->most_filtered = p->filtered;
    sums->texels += p->texels;
    sums->fetched += p->fetched;
    sums->steps += p->steps;
    sums->probes += p->probes;
    sums->surfaces += p->surface;
    sums->rays += p->ray;
    sums->unresolved += p->unknown;
  }
  const double surfaces = sums->surfaces > 0.0 ? sums->surfaces : 1.0, rays = sums->rays > 0.0 ? sums->rays : 1.0;
  sums->filtered /= surfaces;
  sums->texels /= surfaces;
  sums->fetched /= rays;
  sums->steps /= rays;
  sums->probes /= rays;
  sums->unresolved /= rays;
  sums->surfaces /= count;
  sums->rays /= count;
}

bool bench_probe_count(gpu_device *d, const bench_probe *probe, const olx_vulkan_field *field, const rasteriser *raster,
                       const raster_view *view, olx_tracer tracer, olx_select select, uint32_t stride,
                       bench_counts *counts) {
  probe_constants constants = {.tracer = tracer, .select = select, .stride = stride};
  if (!gpu_commands_begin(d)) return false;
  dispatch(d, &probe->counts, field, &probe->counts_set, raster, view, &constants, d->commands);
  gpu_memory_barrier(d, d->commands, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_ACCESS_SHADER_WRITE_BIT,
                     VK_PIPELINE_STAGE_HOST_BIT, VK_ACCESS_HOST_READ_BIT);
  if (!gpu_commands_run(d)) return false;
  const uint32_t width = (raster->images.width + stride - 1) / stride;
  const uint32_t height = (raster->images.height + stride - 1) / stride;
  sum_counts(probe->counted.mapped, width * height, counts);
  return true;
}

void bench_probe_floor(const gpu_device *d, const bench_probe *probe, const olx_vulkan_field *field,
                       const rasteriser *raster, const raster_view *view, bool glossy, VkCommandBuffer commands) {
  probe_constants constants = {.kind = glossy, .stride = 1};
  dispatch(d, &probe->floor, field, &probe->floor_set, raster, view, &constants, commands);
}

bool bench_copy_bandwidth(gpu_device *d, VkDeviceSize bytes, uint32_t rounds, double *gigabytes) {
  gpu_buffer from = {.bytes = 0}, to = {.bytes = 0};
  gpu_timer timer = {.marks = 0};
  const VkBufferUsageFlags usage = VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT;
  *gigabytes = 0.0;
  bool fine = gpu_buffer_create(d, "a buffer to copy", bytes, usage, false, &from) &&
              gpu_buffer_create(d, "a buffer to copy", bytes, usage, false, &to) && gpu_timer_create(d, &timer);
  for (uint32_t i = 0; i < rounds && fine; i++) {
    fine = gpu_commands_begin(d);
    if (!fine) break;
    const VkBufferCopy all = {.size = bytes};
    const VkPipelineStageFlags transfer = VK_PIPELINE_STAGE_TRANSFER_BIT;
    if (i == 0) d->CmdFillBuffer(d->commands, from.buffer, 0, VK_WHOLE_SIZE, 0x3F800000u);
    gpu_memory_barrier(d, d->commands, transfer, VK_ACCESS_TRANSFER_WRITE_BIT, transfer,
                       VK_ACCESS_TRANSFER_READ_BIT | VK_ACCESS_TRANSFER_WRITE_BIT);
    gpu_timer_begin(d, &timer, d->commands);
    d->CmdCopyBuffer(d->commands, from.buffer, to.buffer, 1, &all);
    gpu_timer_mark(d, &timer, d->commands, "copy");
    fine = gpu_commands_run(d);
    double milliseconds[GPU_TIMER_MARKS];
    const char *names[GPU_TIMER_MARKS];
    if (fine && gpu_timer_read(d, &timer, milliseconds, names) == 1 && milliseconds[0] > 0.0) {
      const double found = 2e-6 * (double)bytes / milliseconds[0];
      if (found > *gigabytes) *gigabytes = found;
    }
  }
  gpu_timer_destroy(d, &timer);
  gpu_buffer_destroy(d, &from);
  gpu_buffer_destroy(d, &to);
  return fine;
}
