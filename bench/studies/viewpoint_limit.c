// Measures what limits glossy light that is read from probes: a texel holds light that leaves a surface towards its
// probe, but a reflection needs light that leaves it towards the reflecting surface. For mirror rays from the pixels of
// a camera it compares the field's light, and light path traced towards the probe, with light path traced along the
// ray. The second error is the least that radiance stored by these probes can have.
//
//   viewpoint-limit SCENE FIELD.olx [RAYS]
#include "options.h"
#include "studies.h"

#include <octalux/render.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const char NAME[] = BENCH_PROGRAM " viewpoint-limit";

enum { WIDTH = 160, HEIGHT = 120, PATHS = 256, INDIRECT_BOUNCES = 3 };

static olx_vec3 along(olx_vec3 a, olx_vec3 b, float t) {
  return (olx_vec3){a.x + t * b.x, a.y + t * b.y, a.z + t * b.z};
}
static olx_vec3 minus(olx_vec3 a, olx_vec3 b) { return along(a, b, -1.0f); }
static float dot(olx_vec3 a, olx_vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static olx_vec3 unit(olx_vec3 a) { return along((olx_vec3){0, 0, 0}, a, 1.0f / sqrtf(dot(a, a))); }
static olx_vec3 cross(olx_vec3 a, olx_vec3 b) {
  return (olx_vec3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

// Returns light that leaves `target` towards `eye`, with the number of bounces of a baked texel.
static olx_vec3 light_towards(const olx_scene *scene, olx_vec3 eye, olx_vec3 target) {
  const olx_vec3 way = unit(minus(target, eye));
  olx_camera camera = {.eye = eye, .target = target, .fov_y_degrees = 0.01f};
  camera.up = fabsf(way.y) < 0.9f ? (olx_vec3){0, 1, 0} : (olx_vec3){1, 0, 0};
  olx_render_settings settings = olx_render_settings_default(OLX_METHOD_PATH);
  settings.width = settings.height = 1;
  settings.spp = PATHS;
  settings.bounces = INDIRECT_BOUNCES;
  olx_image image;
  if (olx_render(scene, NULL, &camera, &settings, NULL, &image, NULL) != OLX_OK) exit(1);
  const olx_vec3 light = image.layers[OLX_LAYER_BEAUTY][0];
  olx_image_free(&image);
  return light;
}

// Returns the view ray through a pixel's centre.
static olx_vec3 pixel_direction(const olx_camera *camera, uint32_t pixel, olx_vec3 forward) {
  const olx_vec3 right = unit(cross(forward, camera->up)), up = cross(right, forward);
  const float half = tanf(camera->fov_y_degrees * 0.5f * 3.14159265f / 180.0f);
  const float x = (2.0f * ((float)(pixel % WIDTH) + 0.5f) / WIDTH - 1.0f) * half * WIDTH / HEIGHT;
  const float y = (1.0f - 2.0f * ((float)(pixel / WIDTH) + 0.5f) / HEIGHT) * half;
  return along(along(forward, right, x), up, y);
}

int study_viewpoint_limit(int argc, char **argv) {
  olx_scene *scene = NULL;
  olx_field *field = NULL;
  olx_camera camera;
  if (olx_scene_load(argv[1], &scene) != OLX_OK || olx_field_open(argv[2], &field) != OLX_OK ||
      olx_scene_find_camera(scene, NULL, &camera) != OLX_OK) {
    return library_failure(NAME);
  }
  const uint32_t wanted = argc > 3 ? (uint32_t)atoi(argv[3]) : 500;
  olx_render_settings settings = olx_render_settings_default(OLX_METHOD_FIELD);
  settings.width = WIDTH;
  settings.height = HEIGHT;
  settings.spp = 1;
  olx_image view;
  if (olx_render(scene, field, &camera, &settings, NULL, &view, NULL) != OLX_OK) {
    return library_failure(NAME);
  }
  const olx_vec3 forward = unit(minus(camera.target, camera.eye));
  double field_error = 0, probe_error = 0, power = 0, field_bias = 0, probe_bias = 0, sum = 0;
  uint32_t rays = 0;
  for (uint32_t i = 0; rays < wanted && i < WIDTH * HEIGHT; i++) {
    const uint32_t pixel = (uint32_t)((uint64_t)i * 7919u % (WIDTH * HEIGHT));
    if (dot(view.layers[OLX_LAYER_INDIRECT_GLOSSY][pixel], (olx_vec3){1, 1, 1}) <= 0.0f) continue;
    const olx_vec3 direction = pixel_direction(&camera, pixel, forward), normal = view.layers[OLX_LAYER_NORMAL][pixel];
    const olx_vec3 origin = along(camera.eye, direction, view.layers[OLX_LAYER_DEPTH][pixel].x * 0.9999f);
    const olx_vec3 reflected = unit(along(direction, normal, -2.0f * dot(direction, normal)));
    const olx_trace_hit hit = olx_trace(field, &settings.sample, origin, reflected, INFINITY);
    if (hit.status != OLX_TRACE_HIT || hit.emitter) continue;
    const olx_vec3 truth = light_towards(scene, origin, hit.position);
    const olx_vec3 seen = light_towards(scene, olx_field_probe_position(field, hit.probe), hit.position);
    const olx_vec3 a = minus(hit.radiance, truth), b = minus(seen, truth);
    field_error += (double)dot(a, a), probe_error += (double)dot(b, b), power += (double)dot(truth, truth);
    field_bias += (double)(a.x + a.y + a.z), probe_bias += (double)(b.x + b.y + b.z);
    sum += (double)(truth.x + truth.y + truth.z);
    rays++;
  }
  if (rays == 0) return failure(NAME, "no glossy pixel meets a surface");
  printf("%u mirror rays\n", rays);
  printf("  the field's texel               relative MSE %.4f, bias %+.4f\n", field_error / power, field_bias / sum);
  printf("  a perfect texel of that probe   relative MSE %.4f, bias %+.4f\n", probe_error / power, probe_bias / sum);
  olx_image_free(&view);
  olx_field_close(field);
  olx_scene_free(scene);
  return 0;
}
