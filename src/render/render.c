// Renders images tile by tile in parallel with any of the renderers: casts camera rays, sums samples into layers, and
// warns where field and scene do not match.
#include "core/hooks.h"
#include "core/parallel.h"
#include "core/result.h"
#include "render/field_renderer.h"
#include "render/fixture_light.h"
#include "render/path_tracer.h"
#include "scene/bvh.h"
#include "scene/emitters.h"

#include <octalux/limits.h>

#include <string.h>

olx_render_settings olx_render_settings_default(olx_method method) {
  return (olx_render_settings){
      .width = 1280,
      .height = 720,
      .spp = method == OLX_METHOD_PATH ? 64 : 4,
      .bounces = OLX_BOUNCES_INFINITE,
      .method = method,
      .diffuse = OLX_DIFFUSE_SURFACE,
      .diffuse_samples = 64,
      .glossy_samples = 4,
      .denoise = olx_denoise_settings_default(),
      .sample = olx_sample_settings_default(),
  };
}

typedef struct render_job {
  olx_render_context context;
  olx_tile_renderer renderer;
  olx_image *image;
  olx_lock stats_lock;
  olx_render_stats stats;
} render_job;

// Sums over the samples of a pixel, in double because float sums stagnate after about a million samples.
typedef struct pixel_sum {
  double light[4][3]; // emission, direct, indirect diffuse, indirect glossy
  double albedo[3], normal[3];
  double depth;
  uint32_t hits;
  double mean[3], squares[3]; // of beauty: running mean, and sum of squared deviations from it
} pixel_sum;

static void add3(double sum[3], olx_vec3 v) {
  sum[0] += (double)v.x;
  sum[1] += (double)v.y;
  sum[2] += (double)v.z;
}

static void accumulate(pixel_sum *sum, const olx_camera_sample *sample, uint32_t index) {
  add3(sum->light[0], sample->emission);
  add3(sum->light[1], sample->direct);
  add3(sum->light[2], sample->indirect_diffuse);
  add3(sum->light[3], sample->indirect_glossy);
  add3(sum->albedo, sample->albedo);
  add3(sum->normal, sample->normal);
  if (isfinite(sample->depth)) {
    sum->depth += (double)sample->depth;
    sum->hits++;
  }
  const olx_vec3 beauty =
      olx_add(olx_add(sample->emission, sample->direct), olx_add(sample->indirect_diffuse, sample->indirect_glossy));
  const double values[3] = {(double)beauty.x, (double)beauty.y, (double)beauty.z};
  for (int c = 0; c < 3; c++) {
    const double delta = values[c] - sum->mean[c];
    sum->mean[c] += delta / (index + 1);
    sum->squares[c] += delta * (values[c] - sum->mean[c]);
  }
}

static olx_vec3 scaled3(const double v[3], double scale) {
  return olx_v3((float)(v[0] * scale), (float)(v[1] * scale), (float)(v[2] * scale));
}

static void write_pixel(const olx_image *image, size_t pixel, const pixel_sum *sum, uint32_t spp) {
  const double scale = 1.0 / spp;
  double beauty[3];
  for (int c = 0; c < 3; c++) beauty[c] = sum->light[0][c] + sum->light[1][c] + sum->light[2][c] + sum->light[3][c];
  image->layers[OLX_LAYER_BEAUTY][pixel] = scaled3(beauty, scale);
  image->layers[OLX_LAYER_DIRECT][pixel] = scaled3(sum->light[1], scale);
  image->layers[OLX_LAYER_INDIRECT_DIFFUSE][pixel] = scaled3(sum->light[2], scale);
  image->layers[OLX_LAYER_INDIRECT_GLOSSY][pixel] = scaled3(sum->light[3], scale);
  image->layers[OLX_LAYER_ALBEDO][pixel] = scaled3(sum->albedo, scale);
  image->layers[OLX_LAYER_NORMAL][pixel] = olx_normalize(scaled3(sum->normal, scale));
  const float depth = sum->hits ? (float)(sum->depth / sum->hits) : INFINITY;
  image->layers[OLX_LAYER_DEPTH][pixel] = olx_v3(depth, 0.0f, 0.0f);
  if (image->layers[OLX_LAYER_STANDARD_ERROR]) {
    olx_vec3 error = {0};
    if (spp > 1) {
      const double n = (double)spp * (spp - 1);
      error =
          olx_v3((float)sqrt(sum->squares[0] / n), (float)sqrt(sum->squares[1] / n), (float)sqrt(sum->squares[2] / n));
    }
    image->layers[OLX_LAYER_STANDARD_ERROR][pixel] = error;
  }
}

olx_tile olx_tile_at(uint32_t width, uint32_t height, uint32_t index) {
  const uint32_t tiles_x = (width + OLX_TILE_SIZE - 1) / OLX_TILE_SIZE;
  const uint32_t x0 = index % tiles_x * OLX_TILE_SIZE, y0 = index / tiles_x * OLX_TILE_SIZE;
  const uint32_t right = width - x0, down = height - y0;
  return (olx_tile){x0, y0, right < OLX_TILE_SIZE ? right : OLX_TILE_SIZE, down < OLX_TILE_SIZE ? down : OLX_TILE_SIZE};
}

void olx_tile_cast(const olx_render_context *context, const olx_tile *tile, uint32_t index, bool through_centers,
                   olx_tile_rays *rays, olx_camera_sample *samples) {
  const olx_camera_frame *camera = &context->camera;
  const uint32_t seed = context->settings->seed;
  const uint32_t width = context->settings->width, height = context->settings->height;
  olx_ray cast[OLX_TILE_PIXELS];
  for (uint32_t i = 0; i < rays->count; i++) {
    const uint32_t x = tile->x0 + i % tile->width, y = tile->y0 + i / tile->width;
    rays->samplers[i] = (olx_sampler){.seed = seed ? olx_hash3(x, y, seed) : olx_hash2(x, y), .index = index};
    const olx_vec2 inside = through_centers ? (olx_vec2){0.5f, 0.5f} : olx_sampler_next2(&rays->samplers[i]);
    rays->directions[i] =
        olx_camera_direction(camera, ((float)x + inside.x) / (float)width, ((float)y + inside.y) / (float)height);
    cast[i] = (olx_ray){.origin = camera->eye, .direction = rays->directions[i], .t_max = INFINITY};
  }
  const olx_scene *scene = context->scene;
  olx_bvh_intersect_many(scene->light_bvh, cast, rays->count, true, rays->hits);
  for (uint32_t i = 0; i < rays->count; i++) {
    samples[i] = (olx_camera_sample){.depth = INFINITY};
    if (rays->hits[i].triangle != OLX_NO_HIT) {
      samples[i].depth = rays->hits[i].t * olx_dot(rays->directions[i], camera->forward);
    } else if (olx_environment_lit(scene)) {
      samples[i].emission = olx_environment_radiance(scene, rays->directions[i]);
    }
  }
}

void olx_render_stats_add(olx_render_stats *sum, const olx_render_stats *more) {
  sum->primary_seconds += more->primary_seconds;
  sum->direct_seconds += more->direct_seconds;
  sum->diffuse_seconds += more->diffuse_seconds;
  sum->glossy_seconds += more->glossy_seconds;
  sum->rays += more->rays;
  sum->field_rays += more->field_rays;
  sum->field_unresolved += more->field_unresolved;
  sum->field_steps += more->field_steps;
  sum->field_probes += more->field_probes;
}

static void render_tile(void *user, uint32_t index) {
  render_job *job = user;
  const olx_tile tile = olx_tile_at(job->image->width, job->image->height, index);
  const uint32_t spp = job->context.settings->spp;
  const bool through_centers = spp == 1 || job->context.settings->centered;
  pixel_sum sums[OLX_TILE_PIXELS];
  memset(sums, 0, sizeof sums);
  olx_tile_rays rays = {.count = tile.width * tile.height};
  olx_camera_sample samples[OLX_TILE_PIXELS];
  olx_render_stats stats = {0};
  olx_sky_guide sky;
  olx_sky_guide_begin(&sky);
  if (olx_environment_lit(job->context.scene)) rays.sky = &sky;
  for (uint32_t s = 0; s < spp; s++) {
    const double start = olx_thread_seconds();
    olx_sky_guide_next(&sky, s);
    olx_tile_cast(&job->context, &tile, s, through_centers, &rays, samples);
    stats.primary_seconds += olx_thread_seconds() - start;
    stats.rays += rays.count;
    job->renderer(&job->context, &rays, samples, &stats);
    for (uint32_t i = 0; i < rays.count; i++) accumulate(&sums[i], &samples[i], s);
  }
  for (uint32_t i = 0; i < rays.count; i++) {
    const size_t x = tile.x0 + i % tile.width, y = tile.y0 + i / tile.width;
    write_pixel(job->image, x + (size_t)job->image->width * y, &sums[i], spp);
  }
  olx_lock_take(&job->stats_lock);
  olx_render_stats_add(&job->stats, &stats);
  olx_lock_give(&job->stats_lock);
}

static olx_result check_settings(const olx_render_settings *s, const olx_field *field) {
  if (s->width < 1 || s->width > OLX_PICTURE_SIZE_MOST || s->height < 1 || s->height > OLX_PICTURE_SIZE_MOST) {
    return olx_fail(OLX_ERROR_ARGUMENT, "image size %u x %u is not within 1 to %d", s->width, s->height,
                    OLX_PICTURE_SIZE_MOST);
  }
  if (s->spp < 1 || s->spp > OLX_PICTURE_SPP_MOST) {
    return olx_fail(OLX_ERROR_ARGUMENT, "%u samples a pixel are not within 1 to %d", s->spp, OLX_PICTURE_SPP_MOST);
  }
  if (s->method == OLX_METHOD_PATH) return OLX_OK;
  if (s->method != OLX_METHOD_FIELD && s->method != OLX_METHOD_CLASSIC)
    return olx_fail(OLX_ERROR_ARGUMENT, "there is no render method %d", s->method);
  if (!field) return olx_fail(OLX_ERROR_ARGUMENT, "rendering with a field needs a field");
  if (s->method == OLX_METHOD_CLASSIC) return olx_classic_check(field);
  if (s->diffuse != OLX_DIFFUSE_SURFACE && s->diffuse != OLX_DIFFUSE_IRRADIANCE && s->diffuse != OLX_DIFFUSE_TRACED) {
    return olx_fail(OLX_ERROR_ARGUMENT, "there is no method %d for diffuse light", s->diffuse);
  }
  if (s->diffuse_samples < 1 || s->diffuse_samples > OLX_PICTURE_LOBE_SAMPLES_MOST) {
    return olx_fail(OLX_ERROR_ARGUMENT, "%u diffuse rays are not within 1 to %d", s->diffuse_samples,
                    OLX_PICTURE_LOBE_SAMPLES_MOST);
  }
  if (s->glossy_samples < 1 || s->glossy_samples > OLX_PICTURE_LOBE_SAMPLES_MOST) {
    return olx_fail(OLX_ERROR_ARGUMENT, "%u glossy rays are not within 1 to %d", s->glossy_samples,
                    OLX_PICTURE_LOBE_SAMPLES_MOST);
  }
  if (!(s->dim_lobe >= 0.0f && s->dim_lobe <= 1.0f)) {
    return olx_fail(OLX_ERROR_ARGUMENT, "a dim lobe's reflectance of %g is not within 0 to 1", (double)s->dim_lobe);
  }
  if (s->diffuse == OLX_DIFFUSE_IRRADIANCE) OLX_TRY(olx_probe_light_check(field));
  return olx_sample_settings_check(field, &s->sample);
}

static void warn_of_other_scene(const olx_scene *scene, const olx_field *field) {
  const uint64_t baked = olx_field_describe(field).scene.hash;
  if (baked && baked != scene->hash) {
    olx_log(OLX_LOG_WARNING,
            "the field was baked from another scene (hash %016llx, this one has %016llx): bake it again for true light",
            (unsigned long long)baked, (unsigned long long)scene->hash);
  }
}

static olx_result check_origin(const olx_scene *scene, const olx_field *field) {
  const double *at = scene->origin;
  double baked[3];
  olx_field_origin(field, baked);
  if (at[0] == baked[0] && at[1] == baked[1] && at[2] == baked[2]) return OLX_OK;
  return olx_fail(
      OLX_ERROR_ARGUMENT,
      "the field is relative to (%.17g, %.17g, %.17g) and the scene to (%.17g, %.17g, %.17g): bake it again", baked[0],
      baked[1], baked[2], at[0], at[1], at[2]);
}

olx_result olx_render_check_scene(const olx_scene *scene, const olx_field *field) {
  OLX_TRY(check_origin(scene, field));
  warn_of_other_scene(scene, field);
  return OLX_OK;
}

void olx_render_note_bounces(const olx_field *field, const olx_render_settings *settings, olx_image *image) {
  image->bounces_known = true;
  image->bounces =
      settings->method == OLX_METHOD_PATH ? settings->bounces : olx_field_describe(field).bounces.count + 1;
}

static void warn_of_darkness(const olx_scene *scene) {
  if (olx_emitters_group_count(scene) == 0) {
    olx_log(OLX_LOG_WARNING,
            "the scene has no light: no lamp, no material that shines, no environment; all will be black");
  }
}

olx_result olx_render_check(const olx_scene *scene, const olx_field *field, const olx_render_settings *settings) {
  OLX_TRY(check_settings(settings, field));
  warn_of_darkness(scene);
  if (settings->method == OLX_METHOD_PATH) return OLX_OK;
  return olx_render_check_scene(scene, field);
}

olx_result olx_render(const olx_scene *scene, const olx_field *field, const olx_camera *camera,
                      const olx_render_settings *settings, const olx_progress *progress, olx_image *image,
                      olx_render_stats *stats) {
  *image = (olx_image){0};
  OLX_TRY(olx_render_check(scene, field, settings));
  render_job job = {
      .context = {.scene = scene, .field = field, .settings = settings},
      .renderer = settings->method == OLX_METHOD_PATH ? olx_path_render_tile : olx_field_render_tile,
      .image = image,
  };
  OLX_TRY(olx_camera_frame_make(camera, settings->width, settings->height, &job.context.camera));
  uint32_t layers = (1u << OLX_LAYER_STANDARD_ERROR) - 1;
  if (settings->standard_error) layers |= 1u << OLX_LAYER_STANDARD_ERROR;
  OLX_TRY(olx_image_create(settings->width, settings->height, layers, image));
  olx_result result = OLX_OK;
  if (settings->method == OLX_METHOD_FIELD) result = olx_fixtures_find(&job.context);
  olx_render_note_bounces(field, settings, image);
  const double start = olx_seconds();
  const uint32_t tiles = olx_tile_count(settings->width, settings->height);
  olx_task task;
  olx_task_begin(&task, progress, "render", tiles);
  olx_lock_create(&job.stats_lock);
  if (result == OLX_OK) result = olx_parallel_for(tiles, settings->threads, render_tile, &job, &task, 1);
  olx_lock_destroy(&job.stats_lock);
  olx_task_end(&task);
  olx_near_lamps_free(&job.context.lamps);
  if (result != OLX_OK) {
    olx_image_free(image);
    *image = (olx_image){0};
    return result;
  }
  job.stats.seconds = olx_seconds() - start;
  if (stats) *stats = job.stats;
  return OLX_OK;
}
