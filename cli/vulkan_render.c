// Renders images whose surfaces and direct light come from the CPU, and whose indirect light comes from a field on a
// Vulkan device.
#include "vulkan_render.h"

#include "clock.h"
#include "gpu_memory.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

// Images of the G-buffer, in the order of olx_vulkan_targets, followed by outputs of the passes.
enum {
  DEPTH,
  NORMAL,
  ALBEDO,
  MATERIAL,
  GEOMETRIC_NORMAL,
  VERTEX_NORMAL,
  INPUTS,
  IRRADIANCE = INPUTS,
  GLOSSY,
  COLOR,
  IMAGES
};

typedef struct vulkan_job {
  gpu_device device;
  olx_vulkan_field *field;
  olx_vulkan_frame *frame;
  olx_vulkan_classic *classic; // NULL unless classic maps give the light
  gpu_buffer staging;
  gpu_image images[IMAGES];
  olx_gbuffer gbuffer;
  olx_vulkan_view view;
  olx_vulkan_settings settings;
  vulkan_timing *timing;
} vulkan_job;

static size_t pixel_count(const vulkan_job *job) { return (size_t)job->gbuffer.width * job->gbuffer.height; }

static bool create_images(vulkan_job *job) {
  static const char what[] = "the picture's images";
  const VkImageUsageFlags read = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT;
  const VkImageUsageFlags write =
      VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT;
  bool fine =
      gpu_buffer_create(&job->device, what, 16 * pixel_count(job),
                        VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT, true, &job->staging);
  for (uint32_t i = 0; i < IMAGES && fine; i++) {
    const gpu_image_info info = {.what = what,
                                 .format = i == DEPTH   ? VK_FORMAT_R32_SFLOAT
                                           : i < INPUTS ? VK_FORMAT_R32G32B32A32_SFLOAT
                                                        : VK_FORMAT_R16G16B16A16_SFLOAT,
                                 .width = job->gbuffer.width,
                                 .height = job->gbuffer.height,
                                 .usage = i < INPUTS ? read : write};
    fine = gpu_image_create(&job->device, &info, &job->images[i]);
  }
  return fine;
}

static void fill_staging(const vulkan_job *job, uint32_t image) {
  const olx_gbuffer *g = &job->gbuffer;
  float *to = job->staging.mapped;
  if (image == DEPTH) {
    memcpy(to, g->inverse_depth, pixel_count(job) * sizeof *to);
    return;
  }
  const olx_vec3 *const planes[INPUTS] = {[NORMAL] = g->normal,
                                          [ALBEDO] = g->base_color,
                                          [MATERIAL] = g->material,
                                          [GEOMETRIC_NORMAL] = g->geometric_normal,
                                          [VERTEX_NORMAL] = g->vertex_normal};
  const olx_vec3 *from = planes[image];
  for (size_t i = 0; i < pixel_count(job); i++, to += 4) {
    to[0] = from[i].x;
    to[1] = from[i].y;
    to[2] = from[i].z;
    to[3] = 1.0f;
  }
}

static bool upload_image(vulkan_job *job, uint32_t image) {
  fill_staging(job, image);
  return gpu_image_write(&job->device, &job->images[image], VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL, &job->staging);
}

static void clear_image(vulkan_job *job, uint32_t image, VkImageLayout from) {
  gpu_device *d = &job->device;
  const VkClearColorValue black = {.float32 = {0}};
  const VkImageSubresourceRange range = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
  const VkImageLayout general = VK_IMAGE_LAYOUT_GENERAL;
  gpu_image_barrier(d, d->commands, &job->images[image], from, general);
  d->CmdClearColorImage(d->commands, job->images[image].image, general, &black, 1, &range);
  gpu_image_barrier(d, d->commands, &job->images[image], general, general);
}

static bool clear_outputs(vulkan_job *job) {
  if (!gpu_commands_begin(&job->device)) return false;
  for (uint32_t i = INPUTS; i < IMAGES; i++) clear_image(job, i, VK_IMAGE_LAYOUT_UNDEFINED);
  return gpu_commands_run(&job->device);
}

static bool upload_surfaces(vulkan_job *job) {
  bool fine = true;
  for (uint32_t i = 0; i < INPUTS && fine; i++) fine = upload_image(job, i);
  return fine;
}

static void look_from(vulkan_job *job) {
  job->view = (olx_vulkan_view){.eye = job->gbuffer.eye, .empty_depth = 0.0f};
  memcpy(job->view.clip_to_world, job->gbuffer.clip_to_world, sizeof job->view.clip_to_world);
}

// Returns the passes that the settings call for.
static uint32_t passes_of(const olx_render_settings *s) {
  if (s->method == OLX_METHOD_CLASSIC) return OLX_VULKAN_PASS_COMPOSITE;
  return OLX_VULKAN_PASS_GLOSSY | OLX_VULKAN_PASS_COMPOSITE |
         (s->diffuse == OLX_DIFFUSE_TRACED ? OLX_VULKAN_PASS_DIFFUSE : OLX_VULKAN_PASS_IRRADIANCE);
}

static bool create_frame(vulkan_job *job, uint32_t passes) {
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
                                      .geometric_normal = inputs[GEOMETRIC_NORMAL],
                                      .vertex_normal = inputs[VERTEX_NORMAL],
                                      .irradiance = job->images[IRRADIANCE].view,
                                      .glossy = job->images[GLOSSY].view,
                                      .color = job->images[COLOR].view,
                                      .denoise = job->settings.denoise.lobes,
                                      .passes = passes,
                                      .tracers = 1u << job->settings.sample.tracer,
                                      .selects = 1u << job->settings.sample.select,
                                      .hits = 1u << job->settings.sample.hits};
  return gpu_check_library(&job->device, olx_vulkan_frame_create(job->field, &targets, &job->frame));
}

static float half_float(uint16_t h) {
  const float magnitude =
      ldexpf((float)(h & 0x3FFu) + (h & 0x7C00u ? 1024.0f : 0.0f), (h & 0x7C00u ? h >> 10 & 31 : 1) - 25);
  return h & 0x8000u ? -magnitude : magnitude;
}

typedef olx_result (*record_pass)(const olx_vulkan_frame *frame, VkCommandBuffer commands, const olx_vulkan_view *view,
                                  const olx_vulkan_settings *settings);

// Runs one pass, and adds its time to *taken.
static bool run_pass(vulkan_job *job, record_pass record, double *taken) {
  gpu_device *d = &job->device;
  const double start = clock_seconds(CLOCK_MONOTONIC);
  const bool fine = gpu_commands_begin(d) &&
                    gpu_check_library(d, record(job->frame, d->commands, &job->view, &job->settings)) &&
                    gpu_commands_run(d);
  *taken += clock_seconds(CLOCK_MONOTONIC) - start;
  return fine;
}

// Copies an image to the staging buffer and adds `share` of it to a layer.
static bool add_image(vulkan_job *job, uint32_t image, float share, olx_vec3 *layer) {
  if (!gpu_image_read(&job->device, &job->images[image], VK_IMAGE_LAYOUT_GENERAL, &job->staging)) return false;
  const uint16_t *from = job->staging.mapped;
  for (size_t i = 0; i < pixel_count(job); i++, from += 4) {
    layer[i].x += share * half_float(from[0]);
    layer[i].y += share * half_float(from[1]);
    layer[i].z += share * half_float(from[2]);
  }
  return true;
}

static olx_result record_composite(const olx_vulkan_frame *frame, VkCommandBuffer commands, const olx_vulkan_view *view,
                                   const olx_vulkan_settings *settings) {
  return olx_vulkan_record_composite(frame, commands, view, settings, OLX_VULKAN_ADD_DIFFUSE);
}

// Adds `share` of the diffuse light, shaded from irradiance, to its layer.
static bool add_diffuse(vulkan_job *job, float share, const olx_image *image) {
  if (!gpu_commands_begin(&job->device)) return false;
  clear_image(job, COLOR, VK_IMAGE_LAYOUT_GENERAL);
  return gpu_commands_run(&job->device) && run_pass(job, record_composite, &job->timing->diffuse_seconds) &&
         add_image(job, COLOR, share, image->layers[OLX_LAYER_INDIRECT_DIFFUSE]);
}

static bool add_glossy(vulkan_job *job, float share, const olx_image *image) {
  return add_image(job, GLOSSY, share, image->layers[OLX_LAYER_INDIRECT_GLOSSY]);
}

// Renders light from classic maps, which is the same for all samples of an image.
static bool light_classically(vulkan_job *job, const olx_image *image) {
  gpu_device *d = &job->device;
  const double start = clock_seconds(CLOCK_MONOTONIC);
  const bool fine = gpu_commands_begin(d) &&
                    gpu_check_library(d, olx_vulkan_record_classic(job->frame, job->classic, d->commands, &job->view,
                                                                   &job->settings)) &&
                    gpu_commands_run(d);
  job->timing->diffuse_seconds += clock_seconds(CLOCK_MONOTONIC) - start;
  return fine && add_diffuse(job, 1.0f, image) && add_glossy(job, 1.0f, image);
}

// Returns the number of a sample's rays that one dispatch traces, a divisor of their number. Long dispatches are
// avoided because llvmpipe limits all loops of a thread to 65535 iterations in total.
static uint32_t rays_at_once(uint32_t rays) {
  uint32_t some = 4;
  while (rays % some) some--;
  return some;
}

typedef bool (*add_light)(vulkan_job *job, float share, const olx_image *image);

// Traces one lobe: settings.spp samples with this many rays each.
static bool trace_lobe(vulkan_job *job, uint32_t spp, uint32_t *rays, record_pass record, double *taken, add_light add,
                       const olx_image *image) {
  const uint32_t at_once = rays_at_once(*rays), dispatches = spp * (*rays / at_once);
  bool fine = true;
  *rays = at_once;
  for (uint32_t i = 0; i < dispatches && fine; i++) {
    job->settings.sample_index = i;
    fine = run_pass(job, record, taken) && add(job, 1.0f / (float)dispatches, image);
  }
  return fine;
}

// Renders one image. Irradiance from probes is the same for all samples.
static bool light_picture(vulkan_job *job, const olx_render_settings *settings, const olx_image *image) {
  double *taken = &job->timing->diffuse_seconds;
  const bool fine = settings->diffuse == OLX_DIFFUSE_TRACED
                        ? trace_lobe(job, settings->spp, &job->settings.diffuse_samples, olx_vulkan_record_diffuse,
                                     taken, add_diffuse, image)
                        : run_pass(job, olx_vulkan_record_irradiance, taken) && add_diffuse(job, 1.0f, image);
  return fine && trace_lobe(job, settings->spp, &job->settings.glossy_samples, olx_vulkan_record_glossy,
                            &job->timing->glossy_seconds, add_glossy, image);
}

static bool traces_diffuse(const vulkan_job *job) {
  return (job->settings.denoise.lobes & OLX_VULKAN_LOBE_DIFFUSE) != 0;
}

// Renders one frame of a denoised sequence; its index is in the settings.
static bool light_frame(vulkan_job *job) {
  vulkan_timing *t = job->timing;
  const bool fine = (!traces_diffuse(job) || run_pass(job, olx_vulkan_record_diffuse, &t->diffuse_seconds)) &&
                    run_pass(job, olx_vulkan_record_glossy, &t->glossy_seconds) &&
                    run_pass(job, olx_vulkan_record_denoise, &t->denoise_seconds);
  job->settings.denoise.previous = job->view;
  return fine;
}

static bool show_frame(vulkan_job *job, const olx_image *image) {
  double *taken = &job->timing->diffuse_seconds;
  return (traces_diffuse(job) || run_pass(job, olx_vulkan_record_irradiance, taken)) && add_diffuse(job, 1.0f, image) &&
         add_glossy(job, 1.0f, image);
}

static bool same_camera(const olx_camera *a, const olx_camera *b) {
  return memcmp(&a->eye, &b->eye, sizeof a->eye) == 0 && memcmp(&a->target, &b->target, sizeof a->target) == 0 &&
         memcmp(&a->up, &b->up, sizeof a->up) == 0 && a->fov_y_degrees == b->fov_y_degrees;
}

// Renders the surfaces of a frame, in place of the previous frame's. Only the last image needs all samples of direct
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
                               bool *fine) {
  for (uint32_t i = 0; i < r->camera_count && *fine; i++) {
    if (i > 0 && !same_camera(&r->cameras[i], &r->cameras[i - 1])) {
      const olx_result result = render_surfaces(job, r, i, image, stats);
      if (result != OLX_OK) return result;
      *fine = upload_surfaces(job);
    }
    job->settings.sample_index = job->settings.denoise.frame = i;
    *fine = *fine && light_frame(job);
  }
  *fine = *fine && show_frame(job, image);
  return OLX_OK;
}

// Uploads everything that the relighter has changed since the field was baked.
static bool update_field(vulkan_job *job, const olx_relight *relight) {
  gpu_device *d = &job->device;
  const double start = clock_seconds(CLOCK_MONOTONIC);
  const olx_vulkan_update_settings settings = olx_vulkan_update_settings_default();
  olx_vulkan_update_stats stats = {.waiting_bytes = 1};
  olx_vulkan_update *update;
  bool fine = gpu_check_library(d, olx_vulkan_update_create(job->field, relight, &settings, &update));
  while (fine && stats.waiting_bytes > 0) {
    fine = gpu_commands_begin(d) && gpu_check_library(d, olx_vulkan_record_update(update, d->commands, &stats)) &&
           gpu_commands_run(d);
    job->timing->updated_bytes += stats.bytes;
  }
  olx_vulkan_update_destroy(update);
  job->timing->update_seconds = clock_seconds(CLOCK_MONOTONIC) - start;
  return fine;
}

static bool prepare_device(vulkan_job *job, const vulkan_request *r) {
  const double start = clock_seconds(CLOCK_MONOTONIC);
  gpu_device *d = &job->device;
  const gpu_device_options options = {.validate = r->validate, .compute_only = true, .device = UINT32_MAX};
  if (!gpu_device_open(&options, d)) return false;
  snprintf(job->timing->device, sizeof job->timing->device, "%s", d->properties.deviceName);
  bool fine = gpu_check_library(d, olx_vulkan_field_create(&d->host, r->field, &job->field)) && create_images(job) &&
              upload_surfaces(job) && clear_outputs(job);
  fine = fine && (!r->relight || update_field(job, r->relight)) && create_frame(job, passes_of(r->settings));
  if (fine && r->settings->method == OLX_METHOD_CLASSIC) {
    fine = gpu_check_library(d, olx_vulkan_classic_create(job->field, r->field, &job->classic));
  }
  job->timing->upload_seconds = clock_seconds(CLOCK_MONOTONIC) - start - job->timing->update_seconds;
  return fine;
}

static void release_job(vulkan_job *job) {
  if (job->device.host.device) {
    olx_vulkan_classic_destroy(job->classic);
    olx_vulkan_frame_destroy(job->frame);
    olx_vulkan_field_destroy(job->field);
    for (uint32_t i = 0; i < IMAGES; i++) gpu_image_destroy(&job->device, &job->images[i]);
    gpu_buffer_destroy(&job->device, &job->staging);
    gpu_device_close(&job->device);
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
  settings.irradiance_probes =
      r->settings->diffuse != OLX_DIFFUSE_SURFACE && olx_field_describe(r->field).irradiance.probe_count > 0;
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
                         char problem[VULKAN_PROBLEM_BYTES]) {
  vulkan_job job = {.settings = pass_settings(r), .timing = timing};
  gpu_device *d = &job.device;
  *timing = (vulkan_timing){.device = ""};
  *stats = (olx_render_stats){.seconds = 0};
  *image = (olx_image){.width = 0};
  olx_result result = render_surfaces(&job, r, 0, image, stats);
  bool fine = result != OLX_OK || prepare_device(&job, r);
  if (result == OLX_OK && fine) {
    if (job.classic) fine = light_classically(&job, image);
    else if (r->denoised) result = light_frames(&job, r, image, stats, &fine);
    else fine = light_picture(&job, r->settings, image);
  }
  release_job(&job);
  if (fine && d->validation_messages) fine = gpu_fail(d, "the validation layers found fault (see above)");
  snprintf(problem, VULKAN_PROBLEM_BYTES, "%s", fine ? "" : d->problem);
  if (result == OLX_OK && fine) add_to_beauty(image);
  else olx_image_free(image);
  stats->diffuse_seconds = timing->diffuse_seconds;
  stats->glossy_seconds = timing->glossy_seconds;
  stats->denoise_seconds = timing->denoise_seconds;
  stats->seconds += timing->upload_seconds + timing->update_seconds + timing->diffuse_seconds + timing->glossy_seconds +
                    timing->denoise_seconds;
  return result;
}
