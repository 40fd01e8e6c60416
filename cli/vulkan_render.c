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
  olx_vulkan_classic *classic; // NULL unless its maps give the light
  shared_buffer staging;
  device_image images[IMAGES];
  olx_gbuffer gbuffer;
  olx_vulkan_view view;
  olx_vulkan_settings settings;
  vulkan_timing *timing;
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

static size_t pixel_count(const vulkan_job *job) { return (size_t)job->gbuffer.width * job->gbuffer.height; }

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
    result = device_image_create(&job->device, job->gbuffer.width, job->gbuffer.height, format,
                                 i < INPUTS ? read : write, &job->images[i]);
  }
  return result;
}

static VkBufferImageCopy whole_image(const vulkan_job *job) {
  return (VkBufferImageCopy){.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                             .imageExtent = {job->gbuffer.width, job->gbuffer.height, 1}};
}

static void fill_staging(const vulkan_job *job, uint32_t image) {
  const olx_gbuffer *g = &job->gbuffer;
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

static void clear_image(vulkan_job *job, uint32_t image, VkImageLayout from) {
  vulkan_device *d = &job->device;
  const VkClearColorValue black = {.float32 = {0}};
  const VkImageSubresourceRange range = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
  const VkImageLayout general = VK_IMAGE_LAYOUT_GENERAL;
  device_barrier(d, &job->images[image], from, general);
  d->CmdClearColorImage(d->commands, job->images[image].image, general, &black, 1, &range);
  device_barrier(d, &job->images[image], general, general);
}

static VkResult clear_outputs(vulkan_job *job) {
  const VkResult result = device_commands_begin(&job->device);
  if (result != VK_SUCCESS) return result;
  for (uint32_t i = INPUTS; i < IMAGES; i++) clear_image(job, i, VK_IMAGE_LAYOUT_UNDEFINED);
  return device_commands_run(&job->device);
}

static VkResult upload_surfaces(vulkan_job *job) {
  VkResult result = VK_SUCCESS;
  for (uint32_t i = 0; i < INPUTS && result == VK_SUCCESS; i++) result = upload_image(job, i);
  return result;
}

static void look_from(vulkan_job *job) {
  job->view = (olx_vulkan_view){.eye = job->gbuffer.eye, .empty_depth = 0.0f};
  memcpy(job->view.clip_to_world, job->gbuffer.clip_to_world, sizeof job->view.clip_to_world);
}

// Those that are recorded below.
static uint32_t passes_of(const olx_render_settings *s) {
  if (s->method == OLX_METHOD_CLASSIC) return OLX_VULKAN_PASS_COMPOSITE;
  return OLX_VULKAN_PASS_GLOSSY | OLX_VULKAN_PASS_COMPOSITE |
         (s->diffuse == OLX_DIFFUSE_TRACED ? OLX_VULKAN_PASS_DIFFUSE : OLX_VULKAN_PASS_IRRADIANCE);
}

static olx_result create_frame(vulkan_job *job, uint32_t passes) {
  const VkImageLayout read = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL;
  olx_vulkan_image inputs[INPUTS];
  for (uint32_t i = 0; i < INPUTS; i++)
    inputs[i] = (olx_vulkan_image){job->images[i].view, job->images[i].format, read};
  const olx_vulkan_targets targets = {.width = job->gbuffer.width,
                                      .height = job->gbuffer.height,
                                      .depth = inputs[DEPTH],
                                      .normal = inputs[NORMAL],
                                      .albedo = inputs[ALBEDO],
                                      .roughness = inputs[MATERIAL],
                                      .irradiance = job->images[IRRADIANCE].view,
                                      .glossy = job->images[GLOSSY].view,
                                      .color = job->images[COLOR].view,
                                      .denoise = job->settings.denoise.lobes,
                                      .passes = passes};
  return olx_vulkan_frame_create(job->field, &targets, &job->frame);
}

static float half_float(uint16_t h) {
  const float magnitude =
      ldexpf((float)(h & 0x3FFu) + (h & 0x7C00u ? 1024.0f : 0.0f), (h & 0x7C00u ? h >> 10 & 31 : 1) - 25);
  return h & 0x8000u ? -magnitude : magnitude;
}

typedef olx_result (*record_pass)(const olx_vulkan_frame *frame, VkCommandBuffer commands, const olx_vulkan_view *view,
                                  const olx_vulkan_settings *settings);

// Run one pass; the time it takes is added to *taken.
static const char *run_pass(vulkan_job *job, record_pass record, double *taken) {
  vulkan_device *d = &job->device;
  const double start = seconds();
  const VkResult begun = device_commands_begin(d);
  if (begun != VK_SUCCESS) return problem_of(begun);
  const olx_result result = record(job->frame, d->commands, &job->view, &job->settings);
  const char *problem = result == OLX_OK ? problem_of(device_commands_run(d)) : library_problem(result);
  *taken += seconds() - start;
  return problem;
}

// Copy an image to the staging buffer and add `share` of it to a layer.
static VkResult add_image(vulkan_job *job, uint32_t image, float share, olx_vec3 *layer) {
  vulkan_device *d = &job->device;
  VkResult result = device_commands_begin(d);
  if (result != VK_SUCCESS) return result;
  const VkBufferImageCopy region = whole_image(job);
  const VkImageLayout copy = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL;
  device_barrier(d, &job->images[image], VK_IMAGE_LAYOUT_GENERAL, copy);
  d->CmdCopyImageToBuffer(d->commands, job->images[image].image, copy, job->staging.buffer, 1, &region);
  device_barrier(d, &job->images[image], copy, VK_IMAGE_LAYOUT_GENERAL);
  result = device_commands_run(d);
  if (result != VK_SUCCESS) return result;
  const uint16_t *from = job->staging.mapped;
  for (size_t i = 0; i < pixel_count(job); i++, from += 4) {
    layer[i].x += share * half_float(from[0]);
    layer[i].y += share * half_float(from[1]);
    layer[i].z += share * half_float(from[2]);
  }
  return VK_SUCCESS;
}

static olx_result record_composite(const olx_vulkan_frame *frame, VkCommandBuffer commands, const olx_vulkan_view *view,
                                   const olx_vulkan_settings *settings) {
  return olx_vulkan_record_composite(frame, commands, view, settings, OLX_VULKAN_ADD_DIFFUSE);
}

// Add `share` of the diffuse light, which irradiance gives, to its layer.
static const char *add_diffuse(vulkan_job *job, float share, const olx_image *image) {
  const VkResult begun = device_commands_begin(&job->device);
  if (begun != VK_SUCCESS) return problem_of(begun);
  clear_image(job, COLOR, VK_IMAGE_LAYOUT_GENERAL);
  const char *problem = problem_of(device_commands_run(&job->device));
  if (!problem) problem = run_pass(job, record_composite, &job->timing->diffuse_seconds);
  return problem ? problem : problem_of(add_image(job, COLOR, share, image->layers[OLX_LAYER_INDIRECT_DIFFUSE]));
}

static const char *add_glossy(vulkan_job *job, float share, const olx_image *image) {
  return problem_of(add_image(job, GLOSSY, share, image->layers[OLX_LAYER_INDIRECT_GLOSSY]));
}

// The baseline's light, which is the same for all samples of a picture.
static const char *light_classically(vulkan_job *job, const olx_image *image) {
  vulkan_device *d = &job->device;
  const double start = seconds();
  const VkResult begun = device_commands_begin(d);
  if (begun != VK_SUCCESS) return problem_of(begun);
  const olx_result result =
      olx_vulkan_record_classic(job->frame, job->classic, d->commands, &job->view, &job->settings);
  const char *problem = result == OLX_OK ? problem_of(device_commands_run(d)) : library_problem(result);
  job->timing->diffuse_seconds += seconds() - start;
  if (!problem) problem = add_diffuse(job, 1.0f, image);
  return problem ? problem : add_glossy(job, 1.0f, image);
}

// How many of a sample's rays one dispatch traces: a divisor of them. A dispatch of many is long, and llvmpipe allows
// all loops of a thread 65535 turns together.
static uint32_t rays_at_once(uint32_t rays) {
  uint32_t some = 4;
  while (rays % some) some--;
  return some;
}

typedef const char *(*add_light)(vulkan_job *job, float share, const olx_image *image);

// One lobe by rays, of settings.spp samples of so many rays each.
static const char *trace_lobe(vulkan_job *job, uint32_t spp, uint32_t *rays, record_pass record, double *taken,
                              add_light add, const olx_image *image) {
  const uint32_t at_once = rays_at_once(*rays), dispatches = spp * (*rays / at_once);
  const char *problem = NULL;
  *rays = at_once;
  for (uint32_t i = 0; i < dispatches && !problem; i++) {
    job->settings.sample_index = i;
    problem = run_pass(job, record, taken);
    if (!problem) problem = add(job, 1.0f / (float)dispatches, image);
  }
  return problem;
}

// One picture. Irradiance from probes is the same for all samples.
static const char *light_picture(vulkan_job *job, const olx_render_settings *settings, const olx_image *image) {
  double *taken = &job->timing->diffuse_seconds;
  const char *problem;
  if (settings->diffuse == OLX_DIFFUSE_TRACED) {
    problem = trace_lobe(job, settings->spp, &job->settings.diffuse_samples, olx_vulkan_record_diffuse, taken,
                         add_diffuse, image);
  } else {
    problem = run_pass(job, olx_vulkan_record_irradiance, taken);
    if (!problem) problem = add_diffuse(job, 1.0f, image);
  }
  if (problem) return problem;
  return trace_lobe(job, settings->spp, &job->settings.glossy_samples, olx_vulkan_record_glossy,
                    &job->timing->glossy_seconds, add_glossy, image);
}

// One frame of those that are denoised; its number is in the settings.
static const char *light_frame(vulkan_job *job) {
  const char *problem = NULL;
  if (job->settings.denoise.lobes & OLX_VULKAN_LOBE_DIFFUSE) {
    problem = run_pass(job, olx_vulkan_record_diffuse, &job->timing->diffuse_seconds);
  }
  if (!problem) problem = run_pass(job, olx_vulkan_record_glossy, &job->timing->glossy_seconds);
  if (!problem) problem = run_pass(job, olx_vulkan_record_denoise, &job->timing->denoise_seconds);
  job->settings.denoise.previous = job->view;
  return problem;
}

static const char *show_frame(vulkan_job *job, const olx_image *image) {
  const char *problem = NULL;
  if (!(job->settings.denoise.lobes & OLX_VULKAN_LOBE_DIFFUSE)) {
    problem = run_pass(job, olx_vulkan_record_irradiance, &job->timing->diffuse_seconds);
  }
  if (!problem) problem = add_diffuse(job, 1.0f, image);
  return problem ? problem : add_glossy(job, 1.0f, image);
}

static bool same_camera(const olx_camera *a, const olx_camera *b) {
  return memcmp(&a->eye, &b->eye, sizeof a->eye) == 0 && memcmp(&a->target, &b->target, sizeof a->target) == 0 &&
         memcmp(&a->up, &b->up, sizeof a->up) == 0 && a->fov_y_degrees == b->fov_y_degrees;
}

// The surfaces of a frame, in the place of those of the frame before. Only the last picture needs all samples of direct
// light.
static olx_result render_surfaces(vulkan_job *job, const vulkan_request *r, uint32_t frame, olx_image *image,
                                  olx_render_stats *stats) {
  const olx_camera *camera = &r->cameras[frame];
  olx_render_settings settings = *r->settings;
  if (!same_camera(camera, &r->cameras[r->camera_count - 1])) settings.spp = 1;
  olx_gbuffer_free(&job->gbuffer);
  olx_image_free(image);
  *image = (olx_image){.width = 0};
  olx_render_stats more;
  const olx_result result = olx_render_surfaces(r->scene, r->relight ? olx_relight_field(r->relight) : r->field, camera,
                                                &settings, r->progress, image, &job->gbuffer, &more);
  if (result != OLX_OK) return result;
  stats->seconds += more.seconds;
  stats->primary_seconds += more.primary_seconds;
  stats->direct_seconds += more.direct_seconds;
  stats->rays += more.rays;
  look_from(job);
  return OLX_OK;
}

static olx_result light_frames(vulkan_job *job, const vulkan_request *r, olx_image *image, olx_render_stats *stats,
                               const char **problem) {
  for (uint32_t i = 0; i < r->camera_count && !*problem; i++) {
    if (i > 0 && !same_camera(&r->cameras[i], &r->cameras[i - 1])) {
      const olx_result result = render_surfaces(job, r, i, image, stats);
      if (result != OLX_OK) return result;
      *problem = problem_of(upload_surfaces(job));
      if (*problem) break;
    }
    job->settings.sample_index = job->settings.denoise.frame = i;
    *problem = light_frame(job);
  }
  if (!*problem) *problem = show_frame(job, image);
  return OLX_OK;
}

// Copy all that the relighter has changed since the field was baked.
static const char *update_field(vulkan_job *job, const olx_relight *relight) {
  const double start = seconds();
  const olx_vulkan_update_settings settings = olx_vulkan_update_settings_default();
  olx_vulkan_update_stats stats = {.waiting_bytes = 1};
  olx_vulkan_update *update;
  const char *problem = library_problem(olx_vulkan_update_create(job->field, relight, &settings, &update));
  while (!problem && stats.waiting_bytes > 0) {
    problem = problem_of(device_commands_begin(&job->device));
    if (!problem) problem = library_problem(olx_vulkan_record_update(update, job->device.commands, &stats));
    if (!problem) problem = problem_of(device_commands_run(&job->device));
    job->timing->updated_bytes += stats.bytes;
  }
  olx_vulkan_update_destroy(update);
  job->timing->update_seconds = seconds() - start;
  return problem;
}

static const char *prepare_device(vulkan_job *job, const vulkan_request *r) {
  const double start = seconds();
  const char *problem = vulkan_device_open(&job->device, r->validate);
  if (problem) return problem;
  snprintf(job->timing->device, sizeof job->timing->device, "%s", job->device.name);
  problem = library_problem(olx_vulkan_field_create(&job->device.host, r->field, &job->field));
  if (!problem) problem = problem_of(create_images(job));
  if (!problem) problem = problem_of(upload_surfaces(job));
  if (!problem) problem = problem_of(clear_outputs(job));
  if (!problem) problem = library_problem(create_frame(job, passes_of(r->settings)));
  if (!problem && r->settings->method == OLX_METHOD_CLASSIC) {
    problem = library_problem(olx_vulkan_classic_create(job->field, r->field, &job->classic));
  }
  job->timing->upload_seconds = seconds() - start;
  if (!problem && r->relight) problem = update_field(job, r->relight);
  return problem;
}

static void release_job(vulkan_job *job) {
  if (job->device.host.device) {
    olx_vulkan_classic_destroy(job->classic);
    olx_vulkan_frame_destroy(job->frame);
    olx_vulkan_field_destroy(job->field);
    for (uint32_t i = 0; i < IMAGES; i++) device_image_destroy(&job->device, &job->images[i]);
    shared_buffer_destroy(&job->device, &job->staging);
    vulkan_device_close(&job->device);
  }
  olx_gbuffer_free(&job->gbuffer);
}

static void add_to_beauty(olx_image *image) {
  for (size_t i = 0; i < (size_t)image->width * image->height; i++) {
    const olx_vec3 a = image->layers[OLX_LAYER_INDIRECT_DIFFUSE][i], b = image->layers[OLX_LAYER_INDIRECT_GLOSSY][i];
    olx_vec3 *beauty = &image->layers[OLX_LAYER_BEAUTY][i];
    *beauty = (olx_vec3){beauty->x + a.x + b.x, beauty->y + a.y + b.y, beauty->z + a.z + b.z};
  }
}

static olx_vulkan_settings pass_settings(const vulkan_request *r) {
  olx_vulkan_settings settings = olx_vulkan_settings_default();
  settings.sample = r->settings->sample;
  settings.seed = r->settings->seed;
  settings.dim_lobe = r->settings->dim_lobe;
  settings.denoise.filters = r->settings->denoise;
  if (r->denoised) {
    const bool traced = r->settings->diffuse == OLX_DIFFUSE_TRACED;
    settings.denoise.lobes = OLX_VULKAN_LOBE_GLOSSY | (traced ? OLX_VULKAN_LOBE_DIFFUSE : 0u);
  } else {
    settings.diffuse_samples = r->settings->diffuse_samples;
    settings.glossy_samples = r->settings->glossy_samples;
  }
  return settings;
}

olx_result vulkan_render(const vulkan_request *r, olx_image *image, olx_render_stats *stats, vulkan_timing *timing,
                         const char **problem) {
  vulkan_job job = {.settings = pass_settings(r), .timing = timing};
  *timing = (vulkan_timing){.device = ""};
  *stats = (olx_render_stats){.seconds = 0};
  *image = (olx_image){.width = 0};
  *problem = NULL;
  olx_result result = render_surfaces(&job, r, 0, image, stats);
  if (result == OLX_OK) *problem = prepare_device(&job, r);
  if (result == OLX_OK && !*problem) {
    if (job.classic) *problem = light_classically(&job, image);
    else if (r->denoised) result = light_frames(&job, r, image, stats, problem);
    else *problem = light_picture(&job, r->settings, image);
  }
  release_job(&job);
  if (!*problem && job.device.validation_messages) *problem = "the validation layers found fault (see above)";
  if (result == OLX_OK && !*problem) add_to_beauty(image);
  else olx_image_free(image);
  stats->diffuse_seconds = timing->diffuse_seconds;
  stats->glossy_seconds = timing->glossy_seconds;
  stats->denoise_seconds = timing->denoise_seconds;
  stats->seconds += timing->upload_seconds + timing->update_seconds + timing->diffuse_seconds + timing->glossy_seconds +
                    timing->denoise_seconds;
  return result;
}
