// Finds where the error of a field's glossy layer comes from: glossy-oracle SCENE FIELD.olx [PIXELS]. For pixels of the
// scene's first cameras, whose glossy light is averaged over rays, it compares methods of computing the light of a ray
// with one bounce:
//   field      the field itself;
//   exact, ... the texel of a probe that truly sees the ray's hit: the nearest probe, the one that sees it from
//              the most similar direction, or the one whose texel is smallest there;
//   shaded     the surface in the texel of the finest such probe, shaded for the ray: the result of exact hits;
//   light, ... light computed at the ray's hit, as seen from such a probe: a perfect texel.
// Errors are products of two independent halves, so noise adds nothing to them on average.
#include "core/bsdf.h"
#include "options.h"
#include "render/camera.h"
#include "scene/bvh.h"
#include "scene/direct_light.h"
#include "scene/surface.h"
#include "studies.h"
#include "trace/texel_shade.h"

#include <octalux/sample.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char NAME[] = BENCH_PROGRAM " glossy-oracle";

enum { RAYS = 32, WIDTH = 320, HEIGHT = 180, MOST_CAMERAS = 8 };

typedef enum way { FIELD, EXACT_NEAREST, EXACT_VIEW, EXACT_FINEST, SHADED, LIGHT_NEAREST, LIGHT_VIEW, TRUTH, WAYS } way;
static const char *const way_names[WAYS] = {"field",  "exact, nearest", "exact, nearest in direction", "exact, finest",
                                            "shaded", "light, nearest", "light, nearest in direction", "truth"};

typedef struct oracle {
  const olx_scene *scene;
  const olx_field *field;
  olx_sample_settings settings;
  uint64_t rays, met, unseen, astray;
} oracle;

static olx_vec3 outgoing(oracle *o, const olx_ray_hit *hit, olx_vec3 direction, olx_sampler *sampler) {
  const olx_surface surface = olx_surface_at(o->scene, hit, direction);
  const olx_shading shading = olx_shading_make(&surface, direction);
  uint64_t rays = 0;
  const olx_lobes light = olx_direct_light(o->scene, &shading, sampler, &rays);
  return olx_add(light.diffuse, light.specular);
}

static olx_vec3 texel_light(const olx_field *field, uint32_t probe, olx_vec3 position) {
  const size_t texel = olx_texel_towards(field, olx_sub(position, field->probe_positions[probe]));
  return olx_texel_emits(field, probe, texel) ? olx_splat(0.0f) : olx_texel_radiance(field, probe, texel);
}

static olx_vec3 shaded_light(const olx_field *field, uint32_t probe, olx_vec3 position, olx_vec3 direction) {
  const size_t texel = olx_texel_towards(field, olx_sub(position, field->probe_positions[probe]));
  const olx_texel_light light = olx_texel_shade(field, probe, texel, position, direction, false);
  return olx_add(light.reflected, light.lobe);
}

// Chooses among the probes that truly see the surface: nearest, most similar direction, finest. Returns false when none
// sees it.
static bool choose(const oracle *o, const olx_surface *surface, olx_vec3 towards_eye, uint32_t chosen[3]) {
  float least[3] = {INFINITY, INFINITY, INFINITY};
  for (uint32_t p = 0; p < o->field->info.probes.count; p++) {
    const olx_vec3 offset = olx_sub(o->field->probe_positions[p], surface->position);
    if (o->field->probe_flags[p] & OLX_PROBE_BURIED || olx_dot(offset, surface->geometric_normal) <= 0.0f) continue;
    const olx_ray ray = olx_surface_ray_to(surface, o->field->probe_positions[p], 0.0f);
    if (olx_bvh_occluded(o->scene->bvh, &ray)) continue;
    const float distance = olx_length(offset), cosine = olx_dot(offset, surface->geometric_normal) / distance;
    const float costs[3] = {distance, -olx_dot(offset, towards_eye) / distance, distance / sqrtf(cosine)};
    for (int i = 0; i < 3; i++) {
      if (costs[i] < least[i]) least[i] = costs[i], chosen[i] = p;
    }
  }
  return least[0] < INFINITY;
}

// Computes the result of each method for one ray that leaves `origin`.
static void answer(oracle *o, olx_vec3 origin, olx_vec3 direction, const olx_ray *cast, olx_sampler *sampler,
                   olx_vec3 light[WAYS]) {
  const olx_trace_hit found = olx_trace(o->field, &o->settings, origin, direction, INFINITY);
  const olx_ray_hit hit = olx_bvh_intersect(o->scene->bvh, cast);
  for (int w = 0; w < WAYS; w++) light[w] = found.radiance;
  o->rays++;
  if (hit.triangle == OLX_NO_HIT) {
    light[TRUTH] = olx_splat(0.0f);
    return;
  }
  o->met++;
  o->astray += !(fabsf(found.distance_metres - hit.t) <= olx_max(2.0f * found.footprint_metres, 0.01f * hit.t));
  const olx_surface surface = olx_surface_at(o->scene, &hit, direction);
  light[TRUTH] = outgoing(o, &hit, direction, sampler);
  uint32_t chosen[3];
  if (!choose(o, &surface, olx_negate(direction), chosen)) {
    o->unseen++;
    return;
  }
  for (int i = 0; i < 3; i++) light[EXACT_NEAREST + i] = texel_light(o->field, chosen[i], surface.position);
  light[SHADED] = shaded_light(o->field, chosen[2], surface.position, direction);
  for (int i = 0; i < 2; i++) {
    const olx_vec3 view = olx_normalize(olx_sub(surface.position, o->field->probe_positions[chosen[i]]));
    light[LIGHT_NEAREST + i] = outgoing(o, &hit, view, sampler);
  }
}

// Computes the glossy light of one pixel by every method; `half` selects independent rays.
static bool shade_pixel(oracle *o, const olx_camera_frame *frame, uint32_t pixel, uint32_t half, olx_vec3 sum[WAYS]) {
  const olx_vec3 eye_direction =
      olx_camera_direction(frame, ((float)(pixel % WIDTH) + 0.5f) / WIDTH, ((float)(pixel / WIDTH) + 0.5f) / HEIGHT);
  const olx_ray eye = {frame->eye, eye_direction, 0.0f, INFINITY};
  const olx_ray_hit hit = olx_bvh_intersect(o->scene->bvh, &eye);
  memset(sum, 0, WAYS * sizeof *sum);
  if (hit.triangle == OLX_NO_HIT) return false;
  const olx_surface surface = olx_surface_at(o->scene, &hit, eye_direction);
  const olx_shading shading = olx_shading_make(&surface, eye_direction);
  if (!shading.has_specular) return false;
  const olx_vec3 origin = olx_madd(surface.position, surface.geometric_normal, surface.epsilon);
  for (uint32_t j = 0; j < RAYS; j++) {
    float weight, half_cosine;
    const olx_vec3 local = olx_ggx_sample(surface.bsdf.alpha, shading.view,
                                          olx_stratified2(j, olx_hash3(pixel, half, 3)), &weight, &half_cosine);
    if (weight <= 0.0f) continue;
    const olx_vec3 direction =
        olx_add(olx_add(olx_scale(shading.tangent, local.x), olx_scale(shading.bitangent, local.y)),
                olx_scale(shading.normal, local.z));
    if (olx_dot(direction, surface.geometric_normal) <= 0.0f) continue;
    const olx_ray cast = olx_surface_ray(&surface, direction, INFINITY);
    const olx_vec3 factor = olx_scale(olx_fresnel(&surface.bsdf, half_cosine), weight / RAYS);
    olx_sampler sampler = {.seed = olx_hash3(pixel, half, 5), .index = j};
    olx_vec3 light[WAYS];
    answer(o, origin, direction, &cast, &sampler, light);
    for (int w = 0; w < WAYS; w++) sum[w] = olx_add(sum[w], olx_mul(factor, light[w]));
  }
  return true;
}

static void report(const oracle *o, const char *camera, const double error[WAYS], const double bias[WAYS], double power,
                   double light, double values) {
  printf("%s: %.2f %% of the rays meet something that no probe sees, %.2f %% end elsewhere in the field\n", camera,
         100.0 * (double)o->unseen / (double)o->met, 100.0 * (double)o->astray / (double)o->met);
  for (int w = 0; w < TRUTH; w++) {
    printf("  %-28s MSE %9.3g  relative %7.4f  bias %+7.4f\n", way_names[w], error[w] / values, error[w] / power,
           bias[w] / light);
  }
}

int study_glossy_oracle(int argc, char **argv) {
  olx_scene *scene = NULL;
  olx_field *field = NULL;
  if (olx_scene_load(argv[1], &scene) != OLX_OK || olx_field_open(argv[2], &field) != OLX_OK ||
      olx_probe_light_check(field) != OLX_OK) {
    return library_failure(NAME);
  }
  const uint32_t pixels = argc > 3 ? (uint32_t)atoi(argv[3]) : 1500, cameras = olx_scene_describe(scene).cameras;
  double all_error[WAYS] = {0}, all_bias[WAYS] = {0}, all_power = 0, all_light = 0, all_values = 0;
  oracle all = {.scene = scene, .field = field, .settings = olx_sample_settings_default()};
  for (uint32_t c = 0; c < cameras && c < MOST_CAMERAS; c++) {
    const olx_camera camera = olx_scene_camera(scene, c);
    olx_camera_frame frame;
    if (olx_camera_frame_make(&camera, WIDTH, HEIGHT, &frame) != OLX_OK) return 1;
    double error[WAYS] = {0}, bias[WAYS] = {0}, power = 0, light = 0, values = 0;
    oracle o = {.scene = scene, .field = field, .settings = all.settings};
    for (uint32_t i = 0; i < pixels; i++) {
      const uint32_t pixel = (uint32_t)((uint64_t)i * 7919u * 13u % (WIDTH * HEIGHT));
      olx_vec3 a[WAYS], b[WAYS];
      values += 3.0;
      if (!shade_pixel(&o, &frame, pixel, 0, a) || !shade_pixel(&o, &frame, pixel, 1, b)) continue;
      power += (double)olx_dot(a[TRUTH], b[TRUTH]);
      light += (double)(a[TRUTH].x + a[TRUTH].y + a[TRUTH].z);
      for (int w = 0; w < TRUTH; w++) {
        const olx_vec3 d = olx_sub(a[w], a[TRUTH]), e = olx_sub(b[w], b[TRUTH]);
        error[w] += (double)olx_dot(d, e);
        bias[w] += 0.5 * (double)(d.x + d.y + d.z + e.x + e.y + e.z);
      }
    }
    report(&o, camera.name, error, bias, power, light, values);
    for (int w = 0; w < WAYS; w++) all_error[w] += error[w], all_bias[w] += bias[w];
    all_power += power, all_light += light, all_values += values;
    all.met += o.met, all.unseen += o.unseen, all.astray += o.astray;
  }
  report(&all, "all", all_error, all_bias, all_power, all_light, all_values);
  olx_field_close(field);
  olx_scene_free(scene);
  return 0;
}
