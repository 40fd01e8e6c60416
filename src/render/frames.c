// Renders frames as a real-time renderer does (McGuire et al. 2017, section 5): one camera ray per pixel, one ray per
// lobe, and the denoiser over pixels and frames. Each pass is a function of its buffers.
#include "core/hooks.h"
#include "core/parallel.h"
#include "core/result.h"
#include "render/denoise.h"
#include "render/field_renderer.h"
#include "render/fixture_light.h"

// The surfaces of a frame, which a guide points to.
typedef struct surface_buffers {
  float *depth, *roughness;
  olx_vec3 *normal;
} surface_buffers;

typedef struct frame_job {
  olx_render_context context;
  uint32_t frame;
  olx_ray_turn turn;
  bool last;
  // The surfaces of this frame ([frame & 1]) and of the previous one.
  surface_buffers surfaces[2];
  olx_guide guides[2];
  olx_history diffuse[2], glossy[2];

  olx_incident *diffuse_sample, *glossy_sample; // incident light that this frame's rays found
  olx_vec3 *diffuse_factor, *glossy_factor;     // factors from incident to reflected light
  olx_vec3 *expected;                           // irradiance evaluated without rays
  olx_vec3 *filtered;
  olx_image *image;
  olx_lock stats_lock;
  olx_render_stats stats;
} frame_job;

// ---- Samples of one frame

// A pixel that shows a surface, and its index in the buffers.
typedef struct shaded_pixel {
  size_t pixel;
  const olx_ray_hit *hit;
  olx_shading shading;
  olx_vec3 view;
  olx_sampler sampler;
  bool traces; // in this frame
} shaded_pixel;

// Returns the numbers that a lobe's ray is drawn by.
static olx_vec2 draw_ray(const frame_job *job, const shaded_pixel *p, uint32_t branch) {
  const uint32_t number = olx_ray_turn_number(job->turn.spacing, job->frame);
  return olx_stratified2(number, olx_sampler_split(&p->sampler, branch).seed);
}

static void sample_diffuse(frame_job *job, const shaded_pixel *p, olx_render_stats *stats) {
  olx_incident *sample = &job->diffuse_sample[p->pixel];
  *sample = (olx_incident){.inverse_distance = -1.0f};
  if (!p->traces || !p->shading.has_diffuse || job->context.settings->diffuse != OLX_DIFFUSE_TRACED) return;
  const olx_vec2 random = draw_ray(job, p, OLX_DIFFUSE_BRANCH);
  const olx_field_ray_light found = olx_field_diffuse_ray(&job->context, &p->shading, random, stats);
  *sample = (olx_incident){olx_scale(found.light, OLX_PI), found.nearness};
}

static void sample_glossy(frame_job *job, const shaded_pixel *p, olx_render_stats *stats) {
  olx_incident *sample = &job->glossy_sample[p->pixel];
  *sample = (olx_incident){.inverse_distance = -1.0f};
  const olx_vec3 factor = job->glossy_factor[p->pixel];
  if (!p->traces || !(factor.x > 0.0f)) return;
  const olx_vec2 random = draw_ray(job, p, OLX_GLOSSY_BRANCH);
  const olx_field_ray_light found = olx_field_glossy_ray(&job->context, &p->shading, p->view, random, stats);
  const olx_vec3 light = {found.light.x / factor.x, found.light.y / factor.y, found.light.z / factor.z};
  *sample = (olx_incident){light, found.nearness};
}

// Adds to the last frame all layers of the image except traced light.
static void light_last_frame(frame_job *job, const shaded_pixel *p, olx_render_stats *stats) {
  const uint32_t spp = job->context.settings->spp;
  olx_vec3 sum = {0};
  for (uint32_t s = 0; s < spp; s++) {
    olx_sampler sampler = {.seed = p->sampler.seed, .index = s};
    sum = olx_add(sum, olx_field_direct(&job->context, &p->shading, &sampler, stats));
  }
  job->image->layers[OLX_LAYER_DIRECT][p->pixel] = olx_scale(sum, 1.0f / (float)spp);
  job->expected[p->pixel] = olx_field_irradiance(&job->context, p->hit, &p->shading, p->view);
  if (p->shading.has_specular && olx_field_lobe_is_dim(&job->context, &p->shading)) {
    job->image->layers[OLX_LAYER_INDIRECT_GLOSSY][p->pixel] =
        olx_dim_light(&p->shading.surface->bsdf, p->shading.view.z, job->expected[p->pixel]);
  }
}

static void shade_pixel(frame_job *job, const shaded_pixel *p, olx_render_stats *stats) {
  const olx_surface *surface = p->shading.surface;
  surface_buffers *surfaces = &job->surfaces[job->frame & 1];
  surfaces->normal[p->pixel] = p->shading.normal;
  surfaces->roughness[p->pixel] = surface->roughness;
  job->diffuse_factor[p->pixel] = olx_scale(p->shading.diffuse, 1.0f / OLX_PI);
  const bool traced = p->shading.has_specular && !olx_field_lobe_is_dim(&job->context, &p->shading);
  const olx_vec3 fresnel = olx_fresnel(&surface->bsdf, p->shading.view.z);
  job->glossy_factor[p->pixel] = traced ? olx_max_each(fresnel, olx_splat(OLX_LEAST_FRESNEL)) : olx_splat(0.0f);
  const double start = olx_thread_seconds();
  sample_diffuse(job, p, stats);
  const double diffuse = olx_thread_seconds();
  sample_glossy(job, p, stats);
  const double glossy = olx_thread_seconds();
  if (job->last) {
    job->image->layers[OLX_LAYER_ALBEDO][p->pixel] = surface->bsdf.albedo;
    job->image->layers[OLX_LAYER_NORMAL][p->pixel] = surface->shading_normal;
    light_last_frame(job, p, stats);
    stats->direct_seconds += olx_thread_seconds() - glossy;
  }
  stats->diffuse_seconds += diffuse - start;
  stats->glossy_seconds += glossy - diffuse;
}

static void clear_pixel(frame_job *job, size_t pixel) {
  surface_buffers *surfaces = &job->surfaces[job->frame & 1];
  surfaces->normal[pixel] = olx_splat(0.0f);
  surfaces->roughness[pixel] = 0.0f;
  job->diffuse_factor[pixel] = job->glossy_factor[pixel] = job->expected[pixel] = olx_splat(0.0f);
  job->diffuse_sample[pixel] = job->glossy_sample[pixel] = (olx_incident){.inverse_distance = -1.0f};
}

static void sample_tile(void *user, uint32_t index) {
  frame_job *job = user;
  const uint32_t width = job->context.settings->width;
  const olx_tile tile = olx_tile_at(width, job->context.settings->height, index);
  olx_tile_rays rays = {.count = tile.width * tile.height};
  olx_camera_sample samples[OLX_TILE_PIXELS];
  olx_render_stats stats = {0};
  const double start = olx_thread_seconds();
  olx_tile_cast(&job->context, &tile, job->frame, true, &rays, samples);
  stats.primary_seconds = olx_thread_seconds() - start;
  stats.rays = rays.count;
  for (uint32_t i = 0; i < rays.count; i++) {
    const uint32_t x = tile.x0 + i % tile.width, y = tile.y0 + i / tile.width;
    const size_t pixel = x + (size_t)width * y;
    job->surfaces[job->frame & 1].depth[pixel] = samples[i].depth;
    olx_vec3 emission = samples[i].emission;
    if (rays.hits[i].triangle == OLX_NO_HIT) {
      clear_pixel(job, pixel);
    } else {
      const olx_surface surface = olx_surface_at(job->context.scene, &rays.hits[i], rays.directions[i]);
      const shaded_pixel p = {.pixel = pixel,
                              .hit = &rays.hits[i],
                              .shading = olx_shading_make(&surface, rays.directions[i]),
                              .view = olx_negate(rays.directions[i]),
                              .sampler = rays.samplers[i],
                              .traces = olx_ray_turn_is(&job->turn, x, y)};
      shade_pixel(job, &p, &stats);
      emission = surface.emission;
    }
    if (job->last) job->image->layers[OLX_LAYER_BEAUTY][pixel] = emission;
  }
  olx_lock_take(&job->stats_lock);
  olx_render_stats_add(&job->stats, &stats);
  olx_lock_give(&job->stats_lock);
}

// ---- Frames

static olx_result accumulate(frame_job *job) {
  const olx_render_settings *settings = job->context.settings;
  const uint32_t now = job->frame & 1, before = now ^ 1;
  if (settings->diffuse == OLX_DIFFUSE_TRACED) {
    OLX_TRY(olx_denoise_accumulate(&settings->denoise.diffuse, &job->turn, &job->guides[now], job->diffuse_sample,
                                   &job->guides[before], &job->diffuse[before], &job->diffuse[now], settings->threads));
  }
  return olx_denoise_accumulate(&settings->denoise.glossy, &job->turn, &job->guides[now], job->glossy_sample,
                                &job->guides[before], &job->glossy[before], &job->glossy[now], settings->threads);
}

static olx_result render_frame(frame_job *job, const olx_camera *camera, olx_task *task) {
  const olx_render_settings *settings = job->context.settings;
  const uint32_t now = job->frame & 1;
  OLX_TRY(olx_camera_frame_make(camera, settings->width, settings->height, &job->context.camera));
  job->turn = olx_ray_turn_of(settings->denoise.ray_spacing, job->frame);
  job->guides[now].camera = job->context.camera;
  if (job->frame == 0) job->guides[1].camera = job->context.camera; // the history is empty then
  OLX_TRY(olx_parallel_for(olx_tile_count(settings->width, settings->height), settings->threads, sample_tile, job, task,
                           1));
  const double start = olx_seconds();
  OLX_TRY(accumulate(job));
  job->stats.denoise_seconds += olx_seconds() - start;
  return OLX_OK;
}

// Writes reflected light to the image: `layer` becomes the filtered light times the factor where there is a history,
// and is added to beauty.
static void reflect(frame_job *job, olx_layer layer, const olx_vec3 *filtered, const olx_vec3 *factor) {
  const size_t pixels = (size_t)job->image->width * job->image->height;
  for (size_t i = 0; i < pixels; i++) {
    olx_vec3 *light = &job->image->layers[layer][i];
    *light = olx_add(*light, olx_mul(filtered[i], factor[i]));
    job->image->layers[OLX_LAYER_BEAUTY][i] = olx_add(job->image->layers[OLX_LAYER_BEAUTY][i], *light);
  }
}

static olx_result compose(frame_job *job) {
  const olx_render_settings *settings = job->context.settings;
  const olx_denoise_settings *denoise = &settings->denoise;
  const uint32_t now = job->frame & 1, before = now ^ 1;
  const olx_guide *guide = &job->guides[now];
  const double start = olx_seconds();
  const olx_vec3 *irradiance = job->expected;
  if (settings->diffuse == OLX_DIFFUSE_TRACED) {
    OLX_TRY(olx_denoise_filter(&denoise->diffuse, OLX_LOBE_DIFFUSE, guide, &job->diffuse[now], &job->diffuse[before],
                               job->filtered, settings->threads));
    irradiance = job->filtered;
  }
  reflect(job, OLX_LAYER_INDIRECT_DIFFUSE, irradiance, job->diffuse_factor);
  OLX_TRY(olx_denoise_filter(&denoise->glossy, OLX_LOBE_GLOSSY, guide, &job->glossy[now], &job->glossy[before],
                             job->filtered, settings->threads));
  job->stats.denoise_seconds += olx_seconds() - start;
  reflect(job, OLX_LAYER_INDIRECT_GLOSSY, job->filtered, job->glossy_factor);
  const size_t pixels = (size_t)job->image->width * job->image->height;
  olx_vec3 *const *layers = job->image->layers;
  for (size_t i = 0; i < pixels; i++) {
    layers[OLX_LAYER_BEAUTY][i] = olx_add(layers[OLX_LAYER_BEAUTY][i], layers[OLX_LAYER_DIRECT][i]);
    layers[OLX_LAYER_DEPTH][i] = olx_v3(guide->depth[i], 0.0f, 0.0f);
  }
  return OLX_OK;
}

// ---- The sequence of frames

static olx_result allocate_buffers(frame_job *job) {
  const uint32_t width = job->context.settings->width, height = job->context.settings->height;
  const size_t pixels = (size_t)width * height;
  for (uint32_t i = 0; i < 2; i++) {
    surface_buffers *s = &job->surfaces[i];
    s->depth = olx_allocate_zero(pixels, sizeof *s->depth);
    s->roughness = olx_allocate_zero(pixels, sizeof *s->roughness);
    s->normal = olx_allocate_zero(pixels, sizeof *s->normal);
    if (!s->depth || !s->roughness || !s->normal) goto no_memory;
    job->guides[i] = (olx_guide){
        .width = width, .height = height, .depth = s->depth, .normal = s->normal, .roughness = s->roughness};
    OLX_TRY(olx_history_create(width, height, &job->diffuse[i]));
    OLX_TRY(olx_history_create(width, height, &job->glossy[i]));
  }
  job->diffuse_sample = olx_allocate(pixels, sizeof *job->diffuse_sample);
  job->glossy_sample = olx_allocate(pixels, sizeof *job->glossy_sample);
  job->diffuse_factor = olx_allocate(pixels, sizeof *job->diffuse_factor);
  job->glossy_factor = olx_allocate(pixels, sizeof *job->glossy_factor);
  job->expected = olx_allocate(pixels, sizeof *job->expected);
  job->filtered = olx_allocate(pixels, sizeof *job->filtered);
  if (job->diffuse_sample && job->glossy_sample && job->diffuse_factor && job->glossy_factor && job->expected &&
      job->filtered) {
    return OLX_OK;
  }
no_memory:
  return olx_fail(OLX_ERROR_MEMORY, "render: no memory for frames of %u x %u pixels", width, height);
}

static void release_buffers(frame_job *job) {
  for (uint32_t i = 0; i < 2; i++) {
    olx_release(job->surfaces[i].depth);
    olx_release(job->surfaces[i].roughness);
    olx_release(job->surfaces[i].normal);
    olx_history_free(&job->diffuse[i]);
    olx_history_free(&job->glossy[i]);
  }
  olx_release(job->diffuse_sample);
  olx_release(job->glossy_sample);
  olx_release(job->diffuse_factor);
  olx_release(job->glossy_factor);
  olx_release(job->expected);
  olx_release(job->filtered);
}

static olx_result check_frames(const olx_render_settings *settings, uint32_t count) {
  if (settings->method != OLX_METHOD_FIELD) return olx_fail(OLX_ERROR_ARGUMENT, "frames are rendered with a field");
  if (count < 1) return olx_fail(OLX_ERROR_ARGUMENT, "no frames to render");
  return olx_denoise_settings_check(&settings->denoise);
}

static olx_result render_all(frame_job *job, const olx_camera *cameras, uint32_t count, const olx_progress *progress) {
  const olx_render_settings *settings = job->context.settings;
  olx_task task;
  olx_task_begin(&task, progress, "render frames", (uint64_t)count * olx_tile_count(settings->width, settings->height));
  olx_result result = OLX_OK;
  for (uint32_t i = 0; i < count && result == OLX_OK; i++) {
    job->frame = i;
    job->last = i == count - 1;
    result = render_frame(job, &cameras[i], &task);
  }
  olx_task_end(&task);
  return result == OLX_OK ? compose(job) : result;
}

olx_result olx_render_frames(const olx_scene *scene, const olx_field *field, const olx_camera *cameras, uint32_t count,
                             const olx_render_settings *settings, const olx_progress *progress, olx_image *image,
                             olx_render_stats *stats) {
  *image = (olx_image){0};
  OLX_TRY(check_frames(settings, count));
  OLX_TRY(olx_render_check(scene, field, settings));
  frame_job job = {.context = {.scene = scene, .field = field, .settings = settings}, .image = image};
  const double start = olx_seconds();
  olx_lock_create(&job.stats_lock);
  olx_result result = olx_image_create(settings->width, settings->height, (1u << OLX_LAYER_STANDARD_ERROR) - 1, image);
  if (result == OLX_OK) olx_render_note_bounces(field, settings, image);
  if (result == OLX_OK) result = allocate_buffers(&job);
  if (result == OLX_OK) result = olx_fixtures_find(&job.context);
  if (result == OLX_OK) result = render_all(&job, cameras, count, progress);
  release_buffers(&job);
  olx_near_lamps_free(&job.context.lamps);
  olx_lock_destroy(&job.stats_lock);
  if (result != OLX_OK) {
    olx_image_free(image);
    return result;
  }
  job.stats.seconds = olx_seconds() - start;
  if (stats) *stats = job.stats;
  return OLX_OK;
}
