// Draws the solved light of a scene as a camera sees it, without a field:
//
//   light-picture SCENE PROBES.json|- NOISE IMAGE.exr [CAMERA] [WIDTH HEIGHT]
//
// R, G and B are indirect irradiance at the pixels' centres in W/m^2; interpolated.Y is 1 where it is interpolated
// between records and 0 where a texel would cast rays of its own; records.Y counts the records around the point. With
// "-" the probes are those of the scene's grid.
#include "core/parallel.h"
#include "light/scene_light.h"
#include "light/solution/light_solution.h"
#include "options.h"
#include "render/camera.h"
#include "render/image_io.h"
#include "scene/bvh.h"
#include "solved_probes.h"
#include "studies.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char NAME[] = BENCH_PROGRAM " light-picture";

typedef struct pixel {
  olx_vec3 irradiance;
  float interpolated, records;
} pixel;

typedef struct picture {
  const olx_scene *scene;
  const olx_scene_light *light;
  olx_camera_frame frame;
  uint32_t width, height;
  pixel *pixels;
} picture;

static void draw_pixel(const picture *p, uint32_t x, uint32_t y, pixel *out) {
  const float u = ((float)x + 0.5f) / (float)p->width, v = ((float)y + 0.5f) / (float)p->height;
  const olx_ray ray = {p->frame.eye, olx_camera_direction(&p->frame, u, v), 0.0f, INFINITY};
  const olx_ray_hit hit = olx_bvh_intersect(p->scene->bvh, &ray);
  if (hit.triangle == OLX_NO_HIT) return;
  olx_surface surface = olx_surface_at(p->scene, &hit, ray.direction);
  surface.shading_normal = olx_surface_vertex_normal(p->scene, &hit, &surface);
  const bool found = olx_scene_light_interpolate(p->light, &surface, &out->irradiance);
  if (!found) out->irradiance = olx_scene_light_gather(p->light, &surface, NULL).irradiance;
  out->interpolated = found ? 1.0f : 0.0f;
  out->records = (float)olx_surfel_weigh(&p->light->records.lookup, &surface, false).count;
}

static void draw_row(void *user, uint32_t y) {
  const picture *p = user;
  for (uint32_t x = 0; x < p->width; x++) draw_pixel(p, x, y, &p->pixels[x + (size_t)y * p->width]);
}

static olx_result save(const picture *p, const char *path) {
  enum { STRIDE = sizeof(pixel) / sizeof(float) };
  const pixel *first = p->pixels;
  const olx_exr_channel channels[] = {{"R", &first->irradiance.x, STRIDE},
                                      {"G", &first->irradiance.y, STRIDE},
                                      {"B", &first->irradiance.z, STRIDE},
                                      {"interpolated.Y", &first->interpolated, STRIDE},
                                      {"records.Y", &first->records, STRIDE}};
  const olx_exr_picture file = {p->width, p->height, channels, sizeof channels / sizeof *channels, NULL};
  return olx_exr_write(&file, path);
}

static void report(const picture *p) {
  const olx_scene_light_report r = olx_scene_light_describe(p->light);
  double interpolated = 0.0;
  for (size_t i = 0; i < (size_t)p->width * p->height; i++) interpolated += (double)p->pixels[i].interpolated;
  printf("%u surfels  %u records  %.2f M rays  noise %.2f %%  %.1f s  %.2f %% of the pixels interpolated\n", r.surfels,
         r.records, (double)r.rays * 1e-6, 100.0 * r.noise, r.seconds,
         100.0 * interpolated / ((double)p->width * p->height));
}

// Finds a camera by its name; the first without one.
static olx_result frame_of(const olx_scene *scene, const char *name, picture *p) {
  for (uint32_t i = 0; i < scene->camera_count; i++) {
    if (name && strcmp(scene->cameras[i].name, name) != 0) continue;
    return olx_camera_frame_make(&scene->cameras[i], p->width, p->height, &p->frame);
  }
  return OLX_ERROR_ARGUMENT;
}

int study_light_picture(int argc, char **argv) {
  olx_scene *scene = NULL;
  olx_scene_light *light = NULL;
  solved_probes probes;
  olx_scene_light_settings settings = olx_scene_light_settings_default();
  settings.noise = (float)atof(argv[3]);
  picture p = {.width = argc > 7 ? (uint32_t)atoi(argv[6]) : 640, .height = argc > 7 ? (uint32_t)atoi(argv[7]) : 360};
  if (p.width < 1 || p.height < 1) return usage_error(NAME, "a picture has at least one pixel");
  if (olx_scene_load(argv[1], &scene) != OLX_OK) return library_failure(NAME);
  if (frame_of(scene, argc > 5 ? argv[5] : NULL, &p) != OLX_OK)
    return usage_error(NAME, "the scene has no such camera");
  if (solved_probes_load(scene, argv[2], &probes) != OLX_OK) return library_failure(NAME);
  if (olx_scene_light_create(scene, &settings, probes.positions, probes.flags, probes.count, &light) != OLX_OK) {
    return library_failure(NAME);
  }
  p.scene = scene;
  p.light = light;
  p.pixels = calloc((size_t)p.width * p.height, sizeof *p.pixels);
  if (!p.pixels) return failure(NAME, "out of memory");
  (void)olx_parallel_for(p.height, 0, draw_row, &p, NULL, 0);
  report(&p);
  return save(&p, argv[4]) == OLX_OK ? 0 : library_failure(NAME);
}
