// Renders the input of an external renderer that adds a field's light: a G-buffer of the visible surfaces, and the
// layers that real rays and lights give.
#include "core/hooks.h"
#include "core/parallel.h"
#include "core/result.h"
#include "render/field_renderer.h"

typedef struct gbuffer_job {
  olx_render_context context;
  olx_image *image;
  olx_gbuffer *gbuffer;
  olx_lock stats_lock;
  olx_render_stats stats;
} gbuffer_job;

void olx_gbuffer_free(olx_gbuffer *g) {
  olx_release(g->inverse_depth);
  olx_release(g->normal);
  olx_release(g->geometric_normal);
  olx_release(g->vertex_normal);
  olx_release(g->base_color);
  olx_release(g->material);
  *g = (olx_gbuffer){.width = 0};
}

static olx_result gbuffer_create(uint32_t width, uint32_t height, const olx_camera_frame *camera, olx_gbuffer *g) {
  const size_t count = (size_t)width * height;
  const olx_vec3 f = camera->forward, r = camera->right, u = camera->up, e = camera->eye;
  // Maps (x, y, inverse depth, 1) to forward + x right - y up + inverse depth * eye; w is the inverse depth.
  *g = (olx_gbuffer){.width = width,
                     .height = height,
                     .inverse_depth = olx_allocate_zero(count, sizeof(float)),
                     .normal = olx_allocate_zero(count, sizeof(olx_vec3)),
                     .geometric_normal = olx_allocate_zero(count, sizeof(olx_vec3)),
                     .vertex_normal = olx_allocate_zero(count, sizeof(olx_vec3)),
                     .base_color = olx_allocate_zero(count, sizeof(olx_vec3)),
                     .material = olx_allocate_zero(count, sizeof(olx_vec3)),
                     .eye = e,
                     .clip_to_world = {r.x, r.y, r.z, 0, -u.x, -u.y, -u.z, 0, e.x, e.y, e.z, 1, f.x, f.y, f.z, 0}};
  const bool normals = g->normal && g->geometric_normal && g->vertex_normal;
  if (g->inverse_depth && normals && g->base_color && g->material) return OLX_OK;
  olx_gbuffer_free(g);
  return olx_fail(OLX_ERROR_MEMORY, "no memory for the surfaces of %ux%u pixels", width, height);
}

static void write_surface(const gbuffer_job *job, size_t pixel, const olx_ray_hit *hit, const olx_surface *surface,
                          const olx_shading *shading) {
  olx_gbuffer *g = job->gbuffer;
  g->normal[pixel] = shading->normal;
  g->geometric_normal[pixel] = surface->geometric_normal;
  g->vertex_normal[pixel] = olx_surface_vertex_normal(job->context.scene, hit, surface);
  g->base_color[pixel] = surface->base_color;
  g->material[pixel] = olx_v3(surface->roughness, surface->metallic, surface->bsdf.dielectric_weight);
  job->image->layers[OLX_LAYER_ALBEDO][pixel] = surface->bsdf.albedo;
  job->image->layers[OLX_LAYER_NORMAL][pixel] = surface->shading_normal;
}

static olx_vec3 direct_light(const gbuffer_job *job, const olx_shading *shading, uint32_t seed,
                             olx_render_stats *stats) {
  const uint32_t spp = job->context.settings->spp;
  olx_vec3 sum = {0};
  for (uint32_t s = 0; s < spp; s++) {
    olx_sampler sampler = {.seed = seed, .index = s};
    sum = olx_add(sum, olx_field_direct(&job->context, shading, &sampler, stats));
  }
  return olx_scale(sum, 1.0f / (float)spp);
}

static void render_tile(void *user, uint32_t index) {
  gbuffer_job *job = user;
  const uint32_t width = job->context.settings->width;
  const olx_tile tile = olx_tile_at(width, job->context.settings->height, index);
  olx_tile_rays rays = {.count = tile.width * tile.height};
  olx_camera_sample samples[OLX_TILE_PIXELS];
  olx_render_stats stats = {.rays = rays.count};
  const double start = olx_thread_seconds();
  olx_tile_cast(&job->context, &tile, 0, true, &rays, samples);
  const double cast = olx_thread_seconds();
  for (uint32_t i = 0; i < rays.count; i++) {
    const size_t pixel = tile.x0 + i % tile.width + (size_t)width * (tile.y0 + i / tile.width);
    olx_vec3 emission = samples[i].emission, direct = {0};
    if (rays.hits[i].triangle != OLX_NO_HIT) {
      const olx_surface surface = olx_surface_at(job->context.scene, &rays.hits[i], rays.directions[i]);
      const olx_shading shading = olx_shading_make(&surface, rays.directions[i]);
      write_surface(job, pixel, &rays.hits[i], &surface, &shading);
      job->gbuffer->inverse_depth[pixel] = 1.0f / samples[i].depth;
      emission = surface.emission;
      direct = direct_light(job, &shading, rays.samplers[i].seed, &stats);
    }
    job->image->layers[OLX_LAYER_DEPTH][pixel] = olx_v3(samples[i].depth, 0.0f, 0.0f);
    job->image->layers[OLX_LAYER_DIRECT][pixel] = direct;
    job->image->layers[OLX_LAYER_BEAUTY][pixel] = olx_add(emission, direct);
  }
  stats.primary_seconds = cast - start;
  stats.direct_seconds = olx_thread_seconds() - cast;
  olx_lock_take(&job->stats_lock);
  olx_render_stats_add(&job->stats, &stats);
  olx_lock_give(&job->stats_lock);
}

static olx_result render_tiles(gbuffer_job *job, const olx_progress *progress) {
  const olx_render_settings *settings = job->context.settings;
  const uint32_t tiles = olx_tile_count(settings->width, settings->height);
  olx_task task;
  olx_task_begin(&task, progress, "render surfaces", tiles);
  const olx_result result = olx_parallel_for(tiles, settings->threads, render_tile, job, &task, 1);
  olx_task_end(&task);
  return result;
}

olx_result olx_render_surfaces(const olx_scene *scene, const olx_field *field, const olx_camera *camera,
                               const olx_render_settings *settings, const olx_progress *progress, olx_image *image,
                               olx_gbuffer *gbuffer, olx_render_stats *stats) {
  *image = (olx_image){0};
  *gbuffer = (olx_gbuffer){.width = 0};
  OLX_TRY(olx_render_check(scene, field, settings));
  gbuffer_job job = {
      .context = {.scene = scene, .field = field, .settings = settings}, .image = image, .gbuffer = gbuffer};
  OLX_TRY(olx_camera_frame_make(camera, settings->width, settings->height, &job.context.camera));
  const double start = olx_seconds();
  olx_lock_create(&job.stats_lock);
  olx_result result = olx_image_create(settings->width, settings->height, (1u << OLX_LAYER_STANDARD_ERROR) - 1, image);
  if (result == OLX_OK) olx_render_note_bounces(field, settings, image);
  if (result == OLX_OK) result = gbuffer_create(settings->width, settings->height, &job.context.camera, gbuffer);
  if (result == OLX_OK) result = render_tiles(&job, progress);
  olx_lock_destroy(&job.stats_lock);
  if (result != OLX_OK) {
    olx_gbuffer_free(gbuffer);
    olx_image_free(image);
    return result;
  }
  job.stats.seconds = olx_seconds() - start;
  if (stats) *stats = job.stats;
  return OLX_OK;
}
