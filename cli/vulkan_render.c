#include "vulkan_render.h"
#include "vulkan_device.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

// Images of the G-buffer, in the order of olx_vulkan_targets, and what the passes write.
enum { DEPTH, NORMAL, ALBEDO, MATERIAL, INPUTS, IRRADIANCE = INPUTS, GLOSSY, COLOR, IMAGES };

typedef struct vulkan_job {
  vulkan_device device;
  olx_vulkan_field *field;
  olx_vulkan_frame *frame;
  shared_buffer staging;
  device_image images[IMAGES];
  const olx_gbuffer *gbuffer;
  olx_vulkan_view view;
  olx_vulkan_settings settings;
} vulkan_job;

static double seconds(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static const char *problem_of(VkResult result) {
  switch (result) {
  case VK_SUCCESS: return NULL;
  case VK_ERROR_OUT_OF_HOST_MEMORY: return "out of host memory for the picture's images";
  case VK_ERROR_OUT_OF_DEVICE_MEMORY: return "out of device memory for the picture's images";
  case VK_ERROR_DEVICE_LOST: return "the Vulkan device was lost";
  default: return "the Vulkan device refuses the picture's images";
  }
}

static const char *library_problem(olx_result result) { return result == OLX_OK ? NULL : olx_last_error(); }

static size_t pixel_count(const vulkan_job *job) { return (size_t)job->gbuffer->width * job->gbuffer->height; }

static VkResult create_images(vulkan_job *job) {
  const VkImageUsageFlags read = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT;
  const VkImageUsageFlags write =
      VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT;
  VkResult result =
      shared_buffer_create(&job->device, 16 * pixel_count(job),
                           VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT, &job->staging);
  for (uint32_t i = 0; i < IMAGES && result == VK_SUCCESS; i++) {
    const VkFormat format = i == DEPTH   ? VK_FORMAT_R32_SFLOAT
                            : i < INPUTS ? VK_FORMAT_R32G32B32A32_SFLOAT
                                         : VK_FORMAT_R16G16B16A16_SFLOAT;
    result = device_image_create(&job->device, job->gbuffer->width, job->gbuffer->height, format,
                                 i < INPUTS ? read : write, &job->images[i]);
  }
  return result;
}

static VkBufferImageCopy whole_image(const vulkan_job *job) {
  return (VkBufferImageCopy){.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                             .imageExtent = {job->gbuffer->width, job->gbuffer->height, 1}};
}

static void fill_staging(const vulkan_job *job, uint32_t image) {
  const olx_gbuffer *g = job->gbuffer;
  float *to = job->staging.mapped;
  if (image == DEPTH) {
    memcpy(to, g->inverse_depth, pixel_count(job) * sizeof *to);
    return;
  }
  const olx_vec3 *from = image == NORMAL ? g->normal : image == ALBEDO ? g->base_color : g->material;
  for (size_t i = 0; i < pixel_count(job); i++, to += 4) {
    to[0] = from[i].x;
    to[1] = from[i].y;
    to[2] = from[i].z;
    to[3] = 1.0f;
  }
}

static VkResult upload_image(vulkan_job *job, uint32_t image) {
  vulkan_device *d = &job->device;
  fill_staging(job, image);
  const VkResult result = device_commands_begin(d);
  if (result != VK_SUCCESS) return result;
  const VkBufferImageCopy region = whole_image(job);
  const VkImageLayout copy = VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL;
  device_barrier(d, &job->images[image], VK_IMAGE_LAYOUT_UNDEFINED, copy);
  d->CmdCopyBufferToImage(d->commands, job->staging.buffer, job->images[image].image, copy, 1, &region);
  device_barrier(d, &job->images[image], copy, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL);
  return device_commands_run(d);
}

static VkResult clear_outputs(vulkan_job *job) {
  vulkan_device *d = &job->device;
  const VkResult result = device_commands_begin(d);
  if (result != VK_SUCCESS) return result;
  const VkClearColorValue black = {.float32 = {0}};
  const VkImageSubresourceRange range = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
  for (uint32_t i = INPUTS; i < IMAGES; i++) {
    device_barrier(d, &job->images[i], VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_GENERAL);
    d->CmdClearColorImage(d->commands, job->images[i].image, VK_IMAGE_LAYOUT_GENERAL, &black, 1, &range);
  }
  return device_commands_run(d);
}

static VkResult upload_surfaces(vulkan_job *job) {
  VkResult result = VK_SUCCESS;
  for (uint32_t i = 0; i < INPUTS && result == VK_SUCCESS; i++) result = upload_image(job, i);
  return result == VK_SUCCESS ? clear_outputs(job) : result;
}

static olx_result create_frame(vulkan_job *job) {
  const VkImageLayout read = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL;
  olx_vulkan_image inputs[INPUTS];
  for (uint32_t i = 0; i < INPUTS; i++)
    inputs[i] = (olx_vulkan_image){job->images[i].view, job->images[i].format, read};
  const olx_vulkan_targets targets = {.width = job->gbuffer->width,
                                      .height = job->gbuffer->height,
                                      .depth = inputs[DEPTH],
                                      .normal = inputs[NORMAL],
                                      .albedo = inputs[ALBEDO],
                                      .roughness = inputs[MATERIAL],
                                      .irradiance = job->images[IRRADIANCE].view,
                                      .glossy = job->images[GLOSSY].view,
                                      .color = job->images[COLOR].view};
  return olx_vulkan_frame_create(job->field, &targets, &job->frame);
}

static float half_float(uint16_t h) {
  const float magnitude =
      ldexpf((float)(h & 0x3FFu) + (h & 0x7C00u ? 1024.0f : 0.0f), (h & 0x7C00u ? h >> 10 & 31 : 1) - 25);
  return h & 0x8000u ? -magnitude : magnitude;
}

// End the commands with copying an image to the staging buffer, run them, and add `share` of it to a layer.
static VkResult run_and_add(vulkan_job *job, uint32_t image, float share, olx_vec3 *layer) {
  vulkan_device *d = &job->device;
  const VkBufferImageCopy region = whole_image(job);
  const VkImageLayout copy = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL;
  device_barrier(d, &job->images[image], VK_IMAGE_LAYOUT_GENERAL, copy);
  d->CmdCopyImageToBuffer(d->commands, job->images[image].image, copy, job->staging.buffer, 1, &region);
  device_barrier(d, &job->images[image], copy, VK_IMAGE_LAYOUT_GENERAL);
  const VkResult result = device_commands_run(d);
  if (result != VK_SUCCESS) return result;
  const uint16_t *from = job->staging.mapped;
  for (size_t i = 0; i < pixel_count(job); i++, from += 4) {
    layer[i].x += share * half_float(from[0]);
    layer[i].y += share * half_float(from[1]);
    layer[i].z += share * half_float(from[2]);
  }
  return VK_SUCCESS;
}

static const char *light_diffusely(vulkan_job *job, olx_vec3 *layer) {
  vulkan_device *d = &job->device;
  const VkResult begun = device_commands_begin(d);
  if (begun != VK_SUCCESS) return problem_of(begun);
  olx_result result = olx_vulkan_record_irradiance(job->frame, d->commands, &job->view, &job->settings);
  if (result == OLX_OK) {
    result = olx_vulkan_record_composite(job->frame, d->commands, &job->view, &job->settings, OLX_VULKAN_ADD_DIFFUSE);
  }
  return result == OLX_OK ? problem_of(run_and_add(job, COLOR, 1.0f, layer)) : library_problem(result);
}

static const char *light_glossily(vulkan_job *job, uint32_t spp, olx_vec3 *layer) {
  vulkan_device *d = &job->device;
  for (job->settings.sample_index = 0; job->settings.sample_index < spp; job->settings.sample_index++) {
    const VkResult begun = device_commands_begin(d);
    if (begun != VK_SUCCESS) return problem_of(begun);
    const olx_result result = olx_vulkan_record_glossy(job->frame, d->commands, &job->view, &job->settings);
    const char *problem =
        result == OLX_OK ? problem_of(run_and_add(job, GLOSSY, 1.0f / (float)spp, layer)) : library_problem(result);
    if (problem) return problem;
  }
  return NULL;
}

static const char *run_job(vulkan_job *job, const olx_field *field, uint32_t spp, olx_image *image,
                           vulkan_timing *timing) {
  const double start = seconds();
  const char *problem = library_problem(olx_vulkan_field_create(&job->device.host, field, &job->field));
  if (!problem) problem = problem_of(create_images(job));
  if (!problem) problem = problem_of(upload_surfaces(job));
  if (!problem) problem = library_problem(create_frame(job));
  const double uploaded = seconds();
  if (!problem) problem = light_diffusely(job, image->layers[OLX_LAYER_INDIRECT_DIFFUSE]);
  const double diffuse = seconds();
  if (!problem) problem = light_glossily(job, spp, image->layers[OLX_LAYER_INDIRECT_GLOSSY]);
  timing->upload_seconds = uploaded - start;
  timing->diffuse_seconds = diffuse - uploaded;
  timing->glossy_seconds = seconds() - diffuse;
  return problem;
}

static void release_job(vulkan_job *job) {
  olx_vulkan_frame_destroy(job->frame);
  olx_vulkan_field_destroy(job->field);
  for (uint32_t i = 0; i < IMAGES; i++) device_image_destroy(&job->device, &job->images[i]);
  shared_buffer_destroy(&job->device, &job->staging);
  vulkan_device_close(&job->device);
}

static void add_to_beauty(olx_image *image) {
  for (size_t i = 0; i < (size_t)image->width * image->height; i++) {
    const olx_vec3 a = image->layers[OLX_LAYER_INDIRECT_DIFFUSE][i], b = image->layers[OLX_LAYER_INDIRECT_GLOSSY][i];
    olx_vec3 *beauty = &image->layers[OLX_LAYER_BEAUTY][i];
    *beauty = (olx_vec3){beauty->x + a.x + b.x, beauty->y + a.y + b.y, beauty->z + a.z + b.z};
  }
}

const char *vulkan_render_indirect(const olx_field *field, const olx_gbuffer *gbuffer,
                                   const olx_render_settings *settings, bool validate, olx_image *image,
                                   vulkan_timing *timing) {
  vulkan_job job = {.gbuffer = gbuffer,
                    .view = {.eye = gbuffer->eye, .empty_depth = 0.0f},
                    .settings = {.sample = settings->sample,
                                 .glossy_samples = settings->glossy_samples,
                                 .seed = settings->seed,
                                 .dim_lobe = settings->dim_lobe}};
  *timing = (vulkan_timing){.device = ""};
  memcpy(job.view.clip_to_world, gbuffer->clip_to_world, sizeof job.view.clip_to_world);
  const char *problem = vulkan_device_open(&job.device, validate);
  if (problem) return problem;
  snprintf(timing->device, sizeof timing->device, "%s", job.device.name);
  problem = run_job(&job, field, settings->spp, image, timing);
  if (!problem) add_to_beauty(image);
  release_job(&job);
  if (!problem && job.device.validation_messages) problem = "the validation layers found fault (see above)";
  return problem;
}
