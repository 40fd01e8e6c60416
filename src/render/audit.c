// Measures the errors of a field without an image: its rays against the real triangles, its diffuse light against path
// tracing.
#include "core/hooks.h"
#include "core/parallel.h"
#include "core/result.h"
#include "core/sampling.h"
#include "field/field_data.h"
#include "light/path.h"
#include "render/audit_space.h"
#include "render/camera_sample.h"
#include "scene/bvh.h"
#include "scene/surface.h"
#include "shade/surface_irradiance.h"

#include <octalux/render.h>

#include <stdlib.h>

enum { BATCH = 256, AUDIT_ASPECT_X = 16, AUDIT_ASPECT_Y = 9, MAX_ATTEMPTS = 64 };

// The result of one ray.
typedef struct ray_verdict {
  bool valid, mirror, seen, unresolved, wrong;
  float distance_error; // relative; negative when the ray has none
  uint32_t steps, probes;
} ray_verdict;

// The irradiance at one point, by each method.
typedef struct point_verdict {
  bool valid, stored;
  olx_vec3 surface; // as olx_surface_irradiance returns it: stored, or of the irradiance volume where none is stored
  olx_vec3 probes;  // of irradiance probes alone
  olx_vec3 truth;
} point_verdict;

typedef struct audit {
  const olx_scene *scene;
  const olx_field *field;
  const olx_audit_settings *settings;
  const olx_camera_frame *frames;
  uint32_t frame_count;
  ray_verdict *rays;
  point_verdict *points;
} audit;

olx_audit_settings olx_audit_settings_default(void) {
  return (olx_audit_settings){.rays = 200000, .points = 2000, .spp = 1024, .sample = olx_sample_settings_default()};
}

// Returns a ray to find a surface with: through a random pixel of one of the cameras, or without cameras from a random
// point of the scene's bounds in a random direction.
static olx_ray view_ray(const audit *a, uint32_t index, uint32_t seed) {
  const olx_vec2 random = olx_stratified2(index, seed);
  olx_ray ray = {.t_max = INFINITY};
  if (a->frame_count > 0) {
    const olx_camera_frame *frame = &a->frames[index / 2 % a->frame_count];
    ray.origin = frame->eye;
    ray.direction = olx_camera_direction(frame, random.x, random.y);
    return ray;
  }
  const olx_vec2 more = olx_stratified2(index, seed + 11);
  const olx_vec2 direction = olx_stratified2(index, seed + 23);
  const olx_vec3 size = olx_sub(a->scene->bounds_max, a->scene->bounds_min);
  ray.origin = olx_add(a->scene->bounds_min, olx_mul(size, olx_v3(random.x, random.y, more.x)));
  ray.direction = olx_sample_sphere(direction);
  return ray;
}

// Draws a random surface point that a camera sees; returns false when none of the directions tried hits one.
static bool random_surface(const audit *a, uint32_t index, olx_ray_hit *hit, olx_surface *surface, olx_vec3 *towards) {
  for (uint32_t attempt = 0; attempt < MAX_ATTEMPTS; attempt++) {
    const olx_ray ray = view_ray(a, index, olx_hash3(a->settings->seed, 7, attempt));
    *hit = olx_bvh_intersect(a->scene->bvh, &ray);
    if (hit->triangle == OLX_NO_HIT) continue;
    *surface = olx_surface_at(a->scene, hit, ray.direction);
    *towards = ray.direction;
    return true;
  }
  return false;
}

// Returns whether a probe has an unblocked view of a surface point, from the side on which the ray hit it.
static bool probe_sees(const audit *a, uint32_t probe, const olx_surface *hit) {
  const olx_vec3 position = a->field->probe_positions[probe];
  if (olx_dot(olx_sub(position, hit->position), hit->geometric_normal) <= 0.0f) return false;
  const olx_ray ray = olx_surface_ray_to(hit, position, 0.0f);
  return !olx_bvh_occluded(a->scene->bvh, &ray);
}

static bool probe_sees_sky(const audit *a, uint32_t probe, olx_vec3 direction) {
  const olx_ray ray = {.origin = a->field->probe_positions[probe], .direction = direction, .t_max = INFINITY};
  return !olx_bvh_occluded(a->scene->bvh, &ray);
}

static bool seen_by_some_probe(const audit *a, const olx_surface *hit, olx_vec3 direction) {
  for (uint32_t probe = 0; probe < a->field->info.probes.count; probe++) {
    if (a->field->probe_flags[probe] & OLX_PROBE_BURIED) continue;
    if (hit ? probe_sees(a, probe, hit) : probe_sees_sky(a, probe, direction)) return true;
  }
  return false;
}

static void judge_ray(const audit *a, uint32_t index, ray_verdict *verdict) {
  olx_ray_hit met;
  olx_surface surface;
  olx_vec3 towards;
  if (!random_surface(a, index, &met, &surface, &towards)) return;
  verdict->mirror = index & 1;
  const olx_vec3 normal = surface.geometric_normal;
  const olx_vec3 direction =
      verdict->mirror
          ? olx_normalize(olx_reflect(towards, normal))
          : olx_from_basis(olx_sample_cosine(olx_stratified2(index, olx_hash2(a->settings->seed, 91))), normal);
  if (olx_dot(direction, normal) <= 0.0f) return;
  const olx_ray ray = olx_surface_ray(&surface, direction, INFINITY);
  const olx_ray_hit hit = olx_bvh_intersect(a->scene->bvh, &ray);
  olx_surface true_surface;
  const bool true_hit = hit.triangle != OLX_NO_HIT;
  if (true_hit) true_surface = olx_surface_at(a->scene, &hit, direction);
  verdict->valid = true;
  verdict->seen = seen_by_some_probe(a, true_hit ? &true_surface : NULL, direction);
  const olx_trace_hit answer = olx_trace(a->field, &a->settings->sample, ray.origin, direction, INFINITY);
  verdict->steps = answer.texel_steps;
  verdict->probes = answer.probes_tried;
  verdict->unresolved = answer.status == OLX_TRACE_UNKNOWN;
  verdict->distance_error = -1.0f;
  if (verdict->unresolved) return;
  if ((answer.status == OLX_TRACE_HIT) != true_hit) {
    verdict->wrong = true;
  } else if (true_hit) {
    const float error = fabsf(answer.distance_metres - hit.t);
    verdict->wrong = error > olx_max(2.0f * answer.footprint_metres, 0.01f * hit.t);
    verdict->distance_error = error / hit.t;
  }
}

static void judge_rays(void *user, uint32_t batch) {
  const audit *a = user;
  const uint32_t end = (batch + 1) * BATCH < a->settings->rays ? (batch + 1) * BATCH : a->settings->rays;
  for (uint32_t i = batch * BATCH; i < end; i++) judge_ray(a, i, &a->rays[i]);
}

static void judge_point(void *user, uint32_t index) {
  const audit *a = user;
  const olx_sample_settings *sample = &a->settings->sample;
  olx_ray_hit hit;
  olx_surface s;
  olx_vec3 towards;
  point_verdict *verdict = &a->points[index];
  if (!random_surface(a, index, &hit, &s, &towards)) return;
  s.shading_normal = olx_surface_vertex_normal(a->scene, &hit, &s); // irradiance is about the vertex normal
  const olx_surface_point point = {.position = olx_madd(s.position, s.geometric_normal, s.epsilon),
                                   .geometric_normal = s.geometric_normal,
                                   .vertex_normal = s.shading_normal,
                                   .shading_normal = s.shading_normal,
                                   .view = olx_negate(towards)};
  const olx_surface_light light = olx_surface_light_at(a->field, sample, &point);
  uint64_t rays = 0;
  *verdict = (point_verdict){
      .valid = true,
      .stored = light.probes > 0,
      .surface = light.irradiance,
      .probes = olx_irradiance(a->field, sample, point.position, s.shading_normal, point.view),
      .truth = olx_path_surface_irradiance(a->scene, &s, a->field->info.bounces.count + 1, a->settings->spp,
                                           olx_hash2(a->settings->seed, index), &rays),
  };
}

static int compare_floats(const void *a, const void *b) {
  const float x = *(const float *)a, y = *(const float *)b;
  return (x > y) - (x < y);
}

enum { RAYS_COSINE = 1, RAYS_MIRROR = 2 };

static olx_audit_rays sum_rays(const audit *a, uint32_t kinds, float *errors) {
  olx_audit_rays sum = {0};
  uint64_t unresolved = 0, wrong = 0, seen = 0, unresolved_seen = 0, wrong_seen = 0, steps = 0, probes = 0;
  size_t error_count = 0;
  for (uint32_t i = 0; i < a->settings->rays; i++) {
    const ray_verdict *v = &a->rays[i];
    if (!v->valid || !(kinds & (v->mirror ? RAYS_MIRROR : RAYS_COSINE))) continue;
    sum.count++;
    unresolved += v->unresolved;
    wrong += v->wrong;
    seen += v->seen;
    unresolved_seen += v->unresolved && v->seen;
    wrong_seen += v->wrong && v->seen;
    steps += v->steps;
    probes += v->probes;
    if (v->distance_error >= 0.0f) errors[error_count++] = v->distance_error;
  }
  if (sum.count == 0) return sum;
  const double count = (double)sum.count, seen_count = seen ? (double)seen : 1.0;
  sum.unresolved = (double)unresolved / count;
  sum.wrong = (double)wrong / count;
  sum.unseen = (count - (double)seen) / count;
  sum.unresolved_seen = (double)unresolved_seen / seen_count;
  sum.wrong_seen = (double)wrong_seen / seen_count;
  sum.steps_mean = (double)steps / count;
  sum.probes_mean = (double)probes / count;
  if (error_count > 0) {
    qsort(errors, error_count, sizeof *errors, compare_floats);
    sum.distance_error_median = errors[error_count / 2];
    sum.distance_error_p99 = errors[(error_count - 1) * 99 / 100];
  }
  return sum;
}

enum { POINTS_STORED = 1, POINTS_FALLEN_BACK = 2 };

// Sums the errors at points of the given kinds; with `probes`, those of irradiance probes alone.
static olx_audit_points sum_points(const audit *a, uint32_t kinds, bool probes) {
  double squared = 0.0, reference_squared = 0.0, difference = 0.0, reference = 0.0, dark_estimate = 0.0;
  uint64_t count = 0, dark = 0;
  for (uint32_t i = 0; i < a->settings->points; i++) {
    const point_verdict *v = &a->points[i];
    if (!v->valid || !(kinds & (v->stored ? POINTS_STORED : POINTS_FALLEN_BACK))) continue;
    count++;
    const olx_vec3 estimate = probes ? v->probes : v->surface, d = olx_sub(estimate, v->truth);
    squared += (double)olx_dot(d, d);
    reference_squared += (double)olx_dot(v->truth, v->truth);
    difference += (double)(d.x + d.y + d.z);
    reference += (double)(v->truth.x + v->truth.y + v->truth.z);
    if (olx_max3(v->truth) <= 0.0f) {
      dark++;
      dark_estimate += (double)(estimate.x + estimate.y + estimate.z);
    }
  }
  return (olx_audit_points){
      .count = count,
      .relative_mse = reference_squared > 0.0 ? squared / reference_squared : 0.0,
      .bias = reference > 0.0 ? difference / reference : 0.0,
      .leak = dark > 0 && reference > 0.0 ? dark_estimate / (double)dark / (reference / (double)count) : 0.0,
  };
}

static olx_result make_frames(audit *a, olx_camera_frame *frames) {
  if (a->settings->camera) {
    olx_camera camera;
    OLX_TRY(olx_scene_find_camera(a->scene, a->settings->camera, &camera));
    a->frame_count = 1;
    return olx_camera_frame_make(&camera, AUDIT_ASPECT_X, AUDIT_ASPECT_Y, &frames[0]);
  }
  a->frame_count = a->scene->camera_count;
  for (uint32_t i = 0; i < a->frame_count; i++) {
    OLX_TRY(olx_camera_frame_make(&a->scene->cameras[i], AUDIT_ASPECT_X, AUDIT_ASPECT_Y, &frames[i]));
  }
  return OLX_OK;
}

static olx_result run(audit *a, const olx_progress *progress, olx_audit *out) {
  const uint32_t batches = (a->settings->rays + BATCH - 1) / BATCH;
  olx_task task;
  olx_task_begin(&task, progress, "auditing rays", (uint64_t)batches + a->settings->points + a->settings->space_points);
  olx_result result = olx_parallel_for(batches, a->settings->threads, judge_rays, a, &task, 1);
  olx_task_stage(&task, "auditing points");
  if (result == OLX_OK) result = olx_parallel_for(a->settings->points, a->settings->threads, judge_point, a, &task, 1);
  olx_task_stage(&task, "auditing free space");
  if (result == OLX_OK) result = olx_audit_space(a->scene, a->field, a->settings, &task, out);
  olx_task_end(&task);
  return result;
}

olx_result olx_audit_field(const olx_scene *scene, const olx_field *field, const olx_audit_settings *settings,
                           const olx_progress *progress, olx_audit *out) {
  *out = (olx_audit){0};
  if (settings->rays > 1u << 30 || settings->points > 1u << 30 || settings->space_points > 1u << 26) {
    return olx_fail(OLX_ERROR_ARGUMENT, "audit: at most 2^30 rays and points, 2^26 of them in free space");
  }
  if (settings->spp < 1) return olx_fail(OLX_ERROR_ARGUMENT, "audit: 0 paths a point");
  OLX_TRY(olx_sample_settings_check(field, &settings->sample));
  OLX_TRY(olx_render_check_scene(scene, field));
  audit a = {.scene = scene, .field = field, .settings = settings};
  olx_camera_frame *frames = olx_allocate(scene->camera_count + 1, sizeof *frames);
  a.frames = frames;
  a.rays = olx_allocate_zero(settings->rays, sizeof *a.rays);
  a.points = olx_allocate_zero(settings->points, sizeof *a.points);
  float *errors = olx_allocate(settings->rays, sizeof *errors);
  olx_result result = OLX_OK;
  if (!frames || !a.rays || !a.points || !errors) result = olx_fail(OLX_ERROR_MEMORY, "audit: out of memory");
  if (result == OLX_OK) result = make_frames(&a, frames);
  if (result == OLX_OK) result = run(&a, progress, out);
  if (result == OLX_OK) {
    out->rays = sum_rays(&a, RAYS_COSINE | RAYS_MIRROR, errors);
    out->cosine = sum_rays(&a, RAYS_COSINE, errors);
    out->mirror = sum_rays(&a, RAYS_MIRROR, errors);
    out->points = sum_points(&a, POINTS_STORED | POINTS_FALLEN_BACK, false);
    out->stored = sum_points(&a, POINTS_STORED, false);
    out->fallen_back = sum_points(&a, POINTS_FALLEN_BACK, false);
    if (field->info.irradiance.probe_count) out->irradiance = sum_points(&a, POINTS_STORED | POINTS_FALLEN_BACK, true);
  }
  olx_release(errors);
  olx_release(a.points);
  olx_release(a.rays);
  olx_release(frames);
  return result;
}
