// Finds which rays of glossy light are wrong: glossy-causes SCENE FIELD.olx [PIXELS] [RAYS]. For pixels of the scene's
// cameras it compares the light of rays through the field with path tracing along the same rays, by how they ended:
//   hit       ended where the scene's surface is;
//   beside    ended at another distance;
//   vanished  went behind what a probe sees, and took the indirect light of what hides them;
//   unknown   began where no probe sees anything.
// Of each kind it counts the rays whose true hit no probe sees. Errors of pixels are products of two independent
// halves, so noise adds nothing to them on average; the last column is the error that is left when rays of the kind are
// right.
#include "light/path.h"
#include "options.h"
#include "render/camera.h"
#include "scene/bvh.h"
#include "shade/further.h"
#include "studies.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const char NAME[] = BENCH_PROGRAM " glossy-causes";

enum { WIDTH = 320, HEIGHT = 180, MOST_CAMERAS = 8, HALVES = 2 };

typedef enum cause { RIGHT, BESIDE, VANISHED, UNKNOWN, CAUSES } cause;
static const char *const cause_names[CAUSES] = {"hit", "beside", "vanished", "unknown"};

typedef struct pixel_light {
  olx_vec3 truth, wrong[CAUSES]; // the field's light less the truth, by what became of the rays
} pixel_light;

typedef struct causes {
  const olx_scene *scene;
  const olx_field *field;
  olx_sample_settings settings;
  uint32_t rays_a_pixel;
  double rays[CAUSES], unseen[CAUSES], truth[CAUSES], found[CAUSES];
  double error, without[CAUSES], power;
} causes;

static bool is_seen(const causes *c, const olx_surface *surface) {
  for (uint32_t p = 0; p < c->field->info.probes.count; p++) {
    const olx_vec3 offset = olx_sub(c->field->probe_positions[p], surface->position);
    if (c->field->probe_flags[p] & OLX_PROBE_BURIED || olx_dot(offset, surface->geometric_normal) <= 0.0f) continue;
    const olx_ray ray = olx_surface_ray_to(surface, c->field->probe_positions[p], 0.0f);
    if (!olx_bvh_occluded(c->scene->bvh, &ray)) return true;
  }
  return false;
}

static cause cause_of(const olx_trace_hit *found, const olx_ray_hit *hit) {
  if (found->probe == UINT32_MAX && found->status == OLX_TRACE_UNKNOWN) return UNKNOWN;
  if (found->status == OLX_TRACE_UNKNOWN) return VANISHED;
  if (found->status == OLX_TRACE_MISS) return hit->triangle == OLX_NO_HIT ? RIGHT : BESIDE;
  const float tolerance = olx_max(2.0f * found->footprint_metres, 0.01f * hit->t);
  return hit->triangle != OLX_NO_HIT && fabsf(found->distance_metres - hit->t) <= tolerance ? RIGHT : BESIDE;
}

static olx_vec3 light_of(const causes *c, olx_trace_hit *found, olx_vec3 direction, olx_vec2 random) {
  olx_further_ray further;
  if (!olx_further_draw(c->field, found, direction, random, &further)) return found->radiance;
  const olx_trace_hit second = olx_trace(c->field, &c->settings, further.origin, further.direction, INFINITY);
  return olx_further_light(found, &further, &second);
}

static double sum(olx_vec3 v) { return (double)(v.x + v.y + v.z); }

static void follow(causes *c, const olx_shading *shading, olx_vec2 random, olx_sampler *sampler, pixel_light *light) {
  const olx_surface *surface = shading->surface;
  const olx_lobe_ray lobe = olx_lobe_ray_specular(shading, random);
  if (olx_max3(lobe.weight) <= 0.0f || olx_dot(lobe.direction, surface->geometric_normal) <= 0.0f) return;
  const olx_vec3 origin = olx_madd(surface->position, surface->geometric_normal, surface->epsilon);
  olx_trace_hit found = olx_trace(c->field, &c->settings, origin, lobe.direction, INFINITY);
  const olx_ray cast = olx_surface_ray(surface, lobe.direction, INFINITY);
  const olx_ray_hit hit = olx_bvh_intersect(c->scene->bvh, &cast);
  olx_path path = {c->scene, OLX_BOUNCES_INFINITE, true, *sampler, 0};
  const olx_vec3 truth = olx_path_lobe(&path, surface, &lobe).indirect;
  const olx_vec3 light_found = olx_mul(lobe.weight, light_of(c, &found, lobe.direction, random));
  const cause kind = cause_of(&found, &hit);
  c->rays[kind] += 1.0;
  c->truth[kind] += sum(truth);
  c->found[kind] += sum(light_found);
  if (hit.triangle != OLX_NO_HIT) {
    const olx_surface there = olx_surface_at(c->scene, &hit, lobe.direction);
    c->unseen[kind] += !is_seen(c, &there);
  }
  const float share = 1.0f / (float)c->rays_a_pixel;
  light->truth = olx_madd(light->truth, truth, share);
  light->wrong[kind] = olx_madd(light->wrong[kind], olx_sub(light_found, truth), share);
}

// Computes the glossy light of one pixel; `half` selects independent rays. Returns false where there is none.
static bool shade_pixel(causes *c, const olx_camera_frame *frame, uint32_t pixel, uint32_t half, pixel_light *light) {
  const olx_vec3 direction =
      olx_camera_direction(frame, ((float)(pixel % WIDTH) + 0.5f) / WIDTH, ((float)(pixel / WIDTH) + 0.5f) / HEIGHT);
  const olx_ray eye = {frame->eye, direction, 0.0f, INFINITY};
  const olx_ray_hit hit = olx_bvh_intersect(c->scene->bvh, &eye);
  *light = (pixel_light){0};
  if (hit.triangle == OLX_NO_HIT) return false;
  const olx_surface surface = olx_surface_at(c->scene, &hit, direction);
  const olx_shading shading = olx_shading_make(&surface, direction);
  if (!shading.has_specular) return false;
  for (uint32_t j = 0; j < c->rays_a_pixel; j++) {
    olx_sampler sampler = {.seed = olx_hash3(pixel, half, 5), .index = j};
    follow(c, &shading, olx_stratified2(j, olx_hash3(pixel, half, 3)), &sampler, light);
  }
  return true;
}

static olx_vec3 wrong_but(const pixel_light *light, cause but) {
  olx_vec3 all = olx_splat(0.0f);
  for (cause k = 0; k < CAUSES; k++) all = k == but ? all : olx_add(all, light->wrong[k]);
  return all;
}

static void add_pixel(causes *c, const pixel_light light[HALVES]) {
  c->power += (double)olx_dot(light[0].truth, light[1].truth);
  c->error += (double)olx_dot(wrong_but(&light[0], CAUSES), wrong_but(&light[1], CAUSES));
  for (cause k = 0; k < CAUSES; k++) c->without[k] += (double)olx_dot(wrong_but(&light[0], k), wrong_but(&light[1], k));
}

static void report(const causes *c) {
  double rays = 0.0, truth = 0.0, found = 0.0;
  for (cause k = 0; k < CAUSES; k++) rays += c->rays[k], truth += c->truth[k], found += c->found[k];
  printf("relative MSE %.4f, bias %+.2f %%\n", c->error / c->power, 100.0 * (found / truth - 1.0));
  printf("%-10s %8s %8s %8s %10s %12s\n", "rays", "share", "unseen", "light", "found", "MSE without");
  for (cause k = 0; k < CAUSES; k++) {
    printf("%-10s %7.2f%% %7.2f%% %7.2f%% %9.2f%% %12.4f\n", cause_names[k], 100.0 * c->rays[k] / rays,
           100.0 * c->unseen[k] / rays, 100.0 * c->truth[k] / truth, 100.0 * c->found[k] / truth,
           c->without[k] / c->power);
  }
}

int study_glossy_causes(int argc, char **argv) {
  olx_scene *scene = NULL;
  olx_field *field = NULL;
  if (olx_scene_load(argv[1], &scene) != OLX_OK || olx_field_open(argv[2], &field) != OLX_OK) {
    return library_failure(NAME);
  }
  const uint32_t pixels = argc > 3 ? (uint32_t)atoi(argv[3]) : 1500, cameras = olx_scene_describe(scene).cameras;
  causes c = {.scene = scene, .field = field, .settings = olx_sample_settings_default()};
  c.rays_a_pixel = argc > 4 ? (uint32_t)atoi(argv[4]) : 32;
  for (uint32_t k = 0; k < cameras && k < MOST_CAMERAS; k++) {
    const olx_camera camera = olx_scene_camera(scene, k);
    olx_camera_frame frame;
    if (olx_camera_frame_make(&camera, WIDTH, HEIGHT, &frame) != OLX_OK) return 1;
    for (uint32_t i = 0; i < pixels; i++) {
      const uint32_t pixel = (uint32_t)((uint64_t)i * 7919u * 13u % (WIDTH * HEIGHT));
      pixel_light light[HALVES];
      if (!shade_pixel(&c, &frame, pixel, 0, &light[0]) || !shade_pixel(&c, &frame, pixel, 1, &light[1])) continue;
      add_pixel(&c, light);
    }
  }
  report(&c);
  olx_field_close(field);
  olx_scene_free(scene);
  return 0;
}
