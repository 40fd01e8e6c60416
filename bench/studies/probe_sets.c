// Measures how few probes do as well as a grid: probe-sets SCENE PIXELS FIELD.olx ... It compares glossy light of one
// bounce in random pixels of the scene's cameras, from every field along the very same rays, with direct light where
// these rays truly end. So the noise of rays, and most of the noise of lights, is the same for all fields, and few rays
// suffice to show their differences.
//
// Errors are products of two independent halves of a pixel's rays, so that noise adds nothing to them on average. The
// noise that is left in a ratio to the best grid is estimated by leaving out each twentieth of the pixels (jackknife).
#include "bench_measure.h"
#include "options.h"
#include "render/camera.h"
#include "scene/bvh.h"
#include "scene/direct_light.h"
#include "scene/surface.h"
#include "studies.h"

#include <octalux/sample.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const char NAME[] = BENCH_PROGRAM " probe-sets";

enum { RAYS = 32, WIDTH = 1920, HEIGHT = 1080, MOST_CAMERAS = 8, MOST_FIELDS = 32, PARTS = 20 };

typedef struct sums {
  double error[PARTS], power[PARTS], bias, light;
} sums;

typedef struct comparison {
  const olx_scene *scene;
  uint32_t fields;
  olx_field *field[MOST_FIELDS];
  olx_sample_settings settings;
  sums sum[MOST_FIELDS][MOST_CAMERAS];
} comparison;

static olx_vec3 truth(const comparison *c, const olx_ray *ray, olx_sampler *sampler) {
  const olx_ray_hit hit = olx_bvh_intersect(c->scene->bvh, ray);
  if (hit.triangle == OLX_NO_HIT) return olx_splat(0.0f);
  const olx_surface surface = olx_surface_at(c->scene, &hit, ray->direction);
  const olx_shading shading = olx_shading_make(&surface, ray->direction);
  uint64_t rays = 0;
  const olx_lobes light = olx_direct_light(c->scene, &shading, sampler, &rays);
  return olx_add(light.diffuse, light.specular);
}

// Computes the glossy light of a pixel from every field, followed by the reference; `half` selects independent rays.
// Returns false where nothing is glossy.
static bool shade(const comparison *c, const olx_camera_frame *frame, uint32_t pixel, uint32_t half, olx_vec3 *light) {
  const olx_vec2 random = olx_stratified2(pixel, 77);
  const olx_vec3 eye_direction = olx_camera_direction(frame, random.x, random.y);
  const olx_ray eye = {frame->eye, eye_direction, 0.0f, INFINITY};
  const olx_ray_hit hit = olx_bvh_intersect(c->scene->bvh, &eye);
  for (uint32_t i = 0; i <= c->fields; i++) light[i] = olx_splat(0.0f);
  if (hit.triangle == OLX_NO_HIT) return false;
  const olx_surface surface = olx_surface_at(c->scene, &hit, eye_direction);
  const olx_shading shading = olx_shading_make(&surface, eye_direction);
  if (!shading.has_specular) return false;
  const olx_vec3 origin = olx_madd(surface.position, surface.geometric_normal, surface.epsilon);
  for (uint32_t j = 0; j < RAYS; j++) {
    const olx_lobe_ray lobe = olx_lobe_ray_specular(&shading, olx_stratified2(j, olx_hash3(pixel, half, 3)));
    if (olx_max3(lobe.weight) <= 0.0f) continue;
    const olx_vec3 factor = olx_scale(lobe.weight, 1.0f / RAYS);
    for (uint32_t i = 0; i < c->fields; i++) {
      const olx_trace_hit found = olx_trace(c->field[i], &c->settings, origin, lobe.direction, INFINITY);
      light[i] = olx_add(light[i], olx_mul(factor, found.radiance));
    }
    const olx_ray ray = olx_surface_ray(&surface, lobe.direction, INFINITY);
    olx_sampler sampler = {.seed = olx_hash3(pixel, half, 5), .index = j};
    light[c->fields] = olx_add(light[c->fields], olx_mul(factor, truth(c, &ray, &sampler)));
  }
  return true;
}

static void add_pixel(comparison *c, uint32_t camera, const olx_camera_frame *frame, uint32_t pixel) {
  olx_vec3 a[MOST_FIELDS + 1], b[MOST_FIELDS + 1];
  if (!shade(c, frame, pixel, 0, a) || !shade(c, frame, pixel, 1, b)) return;
  const olx_vec3 ta = a[c->fields], tb = b[c->fields];
  for (uint32_t i = 0; i < c->fields; i++) {
    sums *s = &c->sum[i][camera];
    const olx_vec3 d = olx_sub(a[i], ta), e = olx_sub(b[i], tb);
    s->error[pixel % PARTS] += (double)olx_dot(d, e);
    s->power[pixel % PARTS] += (double)olx_dot(ta, tb);
    s->bias += 0.5 * (double)(d.x + d.y + d.z + e.x + e.y + e.z);
    s->light += 0.5 * (double)(ta.x + ta.y + ta.z + tb.x + tb.y + tb.z);
  }
}

// Returns a field's error over all cameras, excluding one part of the pixels (PARTS: none excluded).
static double error_without(const comparison *c, uint32_t field, uint32_t cameras, uint32_t part) {
  double sum = 0.0;
  for (uint32_t k = 0; k < cameras; k++) {
    for (uint32_t p = 0; p < PARTS; p++) sum += p == part ? 0.0 : c->sum[field][k].error[p];
  }
  return sum;
}

static double ratio_spread(const comparison *c, uint32_t field, uint32_t best, uint32_t cameras) {
  double ratio[PARTS], mean = 0.0, squares = 0.0;
  for (uint32_t p = 0; p < PARTS; p++) {
    ratio[p] = error_without(c, field, cameras, p) / error_without(c, best, cameras, p);
    mean += ratio[p] / PARTS;
  }
  for (uint32_t p = 0; p < PARTS; p++) squares += (ratio[p] - mean) * (ratio[p] - mean);
  return sqrt(squares * (PARTS - 1) / PARTS);
}

static void report(const comparison *c, char **names, uint32_t cameras, uint32_t pixels) {
  uint32_t best = UINT32_MAX;
  for (uint32_t i = 0; i < c->fields; i++) {
    if (!olx_field_describe(c->field[i]).probes.has_grid && best != UINT32_MAX) continue;
    if (best == UINT32_MAX || error_without(c, i, cameras, PARTS) < error_without(c, best, cameras, PARTS)) best = i;
  }
  printf("| field | probes | MB | glossy MSE | relative | bias | over best grid | each camera |\n"
         "| --- | --- | --- | --- | --- | --- | --- | --- |\n");
  for (uint32_t i = 0; i < c->fields; i++) {
    const olx_field_info info = olx_field_describe(c->field[i]);
    const double error = error_without(c, i, cameras, PARTS);
    double power = 0.0, bias = 0.0, light = 0.0;
    for (uint32_t k = 0; k < cameras; k++) {
      for (uint32_t p = 0; p < PARTS; p++) power += c->sum[i][k].power[p];
      bias += c->sum[i][k].bias, light += c->sum[i][k].light;
    }
    printf("| %s | %u | %.0f | %.3g | %.4f | %+.3f | %.2f ± %.2f |", names[i], info.probes.count,
           (double)(bench_geometry_bytes(&info) + bench_light_bytes(&info)) * 1e-6, error / (3.0 * pixels * cameras),
           error / power, bias / light, error / error_without(c, best, cameras, PARTS),
           ratio_spread(c, i, best, cameras));
    for (uint32_t k = 0; k < cameras; k++) {
      double mine = 0.0, of_best = 0.0;
      for (uint32_t p = 0; p < PARTS; p++) mine += c->sum[i][k].error[p], of_best += c->sum[best][k].error[p];
      printf(" %.2f", mine / of_best);
    }
    printf(" |\n");
  }
}

int study_probe_sets(int argc, char **argv) {
  if (argc > 3 + MOST_FIELDS) return usage_error(NAME, "there are more than %d fields", MOST_FIELDS);
  comparison *c = calloc(1, sizeof *c);
  olx_scene *scene = NULL;
  if (!c) return failure(NAME, "out of memory");
  if (olx_scene_load(argv[1], &scene) != OLX_OK) return library_failure(NAME);
  c->scene = scene;
  c->settings = olx_sample_settings_default();
  for (c->fields = 0; (int)c->fields < argc - 3; c->fields++) {
    if (olx_field_open(argv[3 + c->fields], &c->field[c->fields]) != OLX_OK) return library_failure(NAME);
  }
  const uint32_t pixels = (uint32_t)atoi(argv[2]), all = olx_scene_describe(scene).cameras;
  const uint32_t cameras = all < MOST_CAMERAS ? all : MOST_CAMERAS;
  for (uint32_t k = 0; k < cameras; k++) {
    const olx_camera camera = olx_scene_camera(scene, k);
    olx_camera_frame frame;
    if (olx_camera_frame_make(&camera, WIDTH, HEIGHT, &frame) != OLX_OK) return 1;
    for (uint32_t pixel = 0; pixel < pixels; pixel++) add_pixel(c, k, &frame, pixel);
  }
  report(c, argv + 3, cameras, pixels);
  for (uint32_t i = 0; i < c->fields; i++) olx_field_close(c->field[i]);
  olx_scene_free(scene);
  free(c);
  return 0;
}
