// Measures the error of the solved light of a scene: irradiance from surfels at random points that cameras see, against
// path tracing, without the noise of the reference; and how far two solutions with different random numbers differ.
//
//   light-quality SCENE [PROBES.json|-] [NOISE] [SPACING] [MAP] [POINTS] [PATHS] [BOUNCES]
//
// Without a file of probes (or with "-") the probes are those of the scene's grid.
#include "core/parallel.h"
#include "light/links/ray_ends.h"
#include "light/path.h"
#include "light/scene_light.h"
#include "light/solution/light_solution.h"
#include "options.h"
#include "render/camera.h"
#include "scene/bvh.h"
#include "solved_probes.h"
#include "studies.h"

#include <octalux/render.h>

#include <stdio.h>
#include <stdlib.h>

static const char NAME[] = BENCH_PROGRAM " light-quality";

typedef struct point {
  bool valid;
  olx_surface surface;
  olx_vec3 half[2]; // reference, from two halves of the paths
  olx_vec3 found[2];
  bool interpolated; // in the first solution; else its light is gathered
} point;

typedef struct job {
  const olx_scene *scene;
  const olx_scene_light *light[2];
  point *points;
  uint32_t paths, bounces, frames;
  olx_camera_frame frame[64];
} job;

static void make_point(void *user, uint32_t i) {
  job *j = user;
  point *p = &j->points[i];
  for (uint32_t attempt = 0; attempt < 64 && !p->valid; attempt++) {
    const olx_vec2 random = olx_stratified2(i, olx_hash2(77, attempt)),
                   more = olx_stratified2(i, olx_hash2(78, attempt));
    const olx_vec2 direction = olx_stratified2(i, olx_hash2(79, attempt));
    olx_ray ray = {.t_max = INFINITY};
    if (j->frames) {
      const olx_camera_frame *frame = &j->frame[i % j->frames];
      ray.origin = frame->eye;
      ray.direction = olx_camera_direction(frame, random.x, random.y);
    } else {
      const olx_vec3 size = olx_sub(j->scene->bounds_max, j->scene->bounds_min);
      ray.origin = olx_add(j->scene->bounds_min, olx_mul(size, olx_v3(random.x, random.y, more.x)));
      ray.direction = olx_sample_sphere(direction);
    }
    const olx_ray_hit hit = olx_bvh_intersect(j->scene->bvh, &ray);
    if (hit.triangle == OLX_NO_HIT) continue;
    p->surface = olx_surface_at(j->scene, &hit, ray.direction);
    p->surface.shading_normal = olx_surface_vertex_normal(j->scene, &hit, &p->surface);
    p->valid = true;
  }
  if (!p->valid) return;
  uint64_t rays = 0;
  for (uint32_t half = 0; half < 2; half++) {
    p->half[half] =
        olx_path_surface_irradiance(j->scene, &p->surface, j->bounces, j->paths, olx_hash3(i, half, 5), &rays);
  }
}

static void look_up(void *user, uint32_t i) {
  job *j = user;
  if (!j->points[i].valid) return;
  for (uint32_t k = 0; k < 2; k++)
    j->points[i].found[k] = olx_scene_light_irradiance(j->light[k], &j->points[i].surface);
  olx_vec3 light;
  j->points[i].interpolated = olx_scene_light_interpolate(j->light[0], &j->points[i].surface, &light);
}

static double dot3(olx_vec3 a, olx_vec3 b) { return (double)a.x * b.x + (double)a.y * b.y + (double)a.z * b.z; }

static int by_value(const void *a, const void *b) {
  const double x = *(const double *)a, y = *(const double *)b;
  return x < y ? -1 : x > y;
}

static void report_points(const job *j, uint32_t count) {
  double squares = 0, error = 0, bias = 0, sum = 0, two = 0;
  double *each = malloc(count * sizeof *each);
  uint32_t valid = 0, bright = 0, dark = 0;
  for (uint32_t i = 0; i < count; i++) {
    const point *p = &j->points[i];
    if (!p->valid) continue;
    const olx_vec3 truth = olx_scale(olx_add(p->half[0], p->half[1]), 0.5f);
    sum += (double)olx_luminance(truth);
    squares += dot3(p->half[0], p->half[1]);
  }
  for (uint32_t i = 0; i < count; i++) {
    const point *p = &j->points[i];
    if (!p->valid) continue;
    const olx_vec3 truth = olx_scale(olx_add(p->half[0], p->half[1]), 0.5f);
    const double e = dot3(olx_sub(p->found[0], p->half[0]), olx_sub(p->found[0], p->half[1]));
    each[valid++] = e;
    error += e;
    bias += (double)olx_luminance(p->found[0]) - (double)olx_luminance(truth);
    const olx_vec3 between = olx_sub(p->found[0], p->found[1]);
    two += dot3(between, between);
    const float ratio = olx_luminance(p->found[0]) / olx_max(olx_luminance(truth), 1e-9f);
    if (olx_luminance(truth) > 0.01 * sum / count) bright += ratio > 1.3f, dark += ratio < 1.0f / 1.3f;
  }
  qsort(each, valid, sizeof *each, by_value);
  double worst = 0;
  for (uint32_t i = valid - valid / 100; i < valid; i++) worst += each[i];
  printf("relative MSE %.5f (worst 1%% of points: %.5f)  bias %+.2f %%  two seeds RMS %.2f %%  >1.3: %.2f %%  <1/1.3: "
         "%.2f %%\n",
         error / squares, worst / squares, 100 * bias / sum, 100 * sqrt(two / squares), 100.0 * bright / valid,
         100.0 * dark / valid);
  free(each);
}

// Prints the part that points whose light is interpolated, or gathered, have in the error and the difference of all.
static void report_part(const job *j, uint32_t count, bool interpolated) {
  double squares = 0, error = 0, two = 0;
  uint32_t valid = 0, part = 0;
  for (uint32_t i = 0; i < count; i++) {
    const point *p = &j->points[i];
    if (!p->valid) continue;
    valid++;
    squares += dot3(p->half[0], p->half[1]);
    if (p->interpolated != interpolated) continue;
    const olx_vec3 between = olx_sub(p->found[0], p->found[1]);
    part++;
    error += dot3(olx_sub(p->found[0], p->half[0]), olx_sub(p->found[0], p->half[1]));
    two += dot3(between, between);
  }
  printf("%s: %.1f %% of the points; relative MSE %.5f, squared difference of two seeds %.5f, as parts of all\n",
         interpolated ? "interpolated" : "gathered", 100.0 * part / valid, error / squares, two / squares);
}

enum { GUIDED_RAYS = 2048 };

// What rays find, each as an estimate of irradiance.
typedef struct ray_sums {
  double sum, squares, rays;
} ray_sums;

// Adds rays that are divided by a pool's density, or evenly when that is NULL.
static void add_rays(const olx_scene_light *l, const olx_surface *surface, const olx_ray_pool *pool, uint32_t seed,
                     ray_sums *all) {
  const olx_passed_light light = {olx_light_direct(l), l->passed_on, l->settings.bounces};
  const olx_ray_caster caster = {.surfels = &l->surfels};
  const olx_bin_sequence sequence = olx_bin_sequence_make(seed);
  uint16_t bins[OLX_GUIDE_BINS];
  olx_guide_divide(pool, GUIDED_RAYS, bins);
  for (uint32_t bin = 0; bin < OLX_GUIDE_BINS; bin++) {
    for (uint32_t i = 0; i < bins[bin]; i++) {
      const olx_ray_draw draw = olx_ray_draw_in_bin(&sequence, bin, i);
      const float factor = (float)GUIDED_RAYS / (float)(OLX_GUIDE_BINS * bins[bin]);
      olx_ray_end end = olx_ray_end_none();
      olx_ray_ends_cast(&caster, surface, &draw, 1, &end);
      const double found = (double)olx_luminance(olx_ray_end_light(&end, factor, 1.0f, &light));
      all->sum += found;
      all->squares += found * found;
      all->rays++;
    }
  }
}

static double deviation_of(const ray_sums *all) {
  const double mean = all->sum / all->rays;
  return sqrt(all->squares / all->rays - mean * mean) / mean;
}

// Prints the standard deviation of the light that one ray brings, over its mean, for rays drawn evenly and by the
// guide.
static void report_rays(const job *j, uint32_t count) {
  enum { PLACES = 400 };
  const olx_scene_light *l = j->light[0];
  ray_sums even = {0}, guided = {0};
  for (uint32_t i = 0; i < count && i < PLACES; i++) {
    const olx_surface *surface = &j->points[i].surface;
    if (!j->points[i].valid) continue;
    const uint64_t key = olx_cell_key(&l->surfels.grid, surface->position, surface->geometric_normal);
    const uint32_t near = olx_light_surfels_find(&l->surfels, key, surface, INFINITY).surfel;
    if (near == OLX_CELL_NONE) continue;
    add_rays(l, surface, NULL, olx_hash(i), &even);
    add_rays(l, surface, olx_light_pool(l, near), olx_hash(i), &guided);
  }
  printf("a ray's deviation over its mean: even %.2f, guided %.2f\n", deviation_of(&even), deviation_of(&guided));
}

static void print_report(const olx_scene_light_report *r) {
  printf("%u surfels (%u hidden)  %u records  %.2f M rays  %.2f M links  %.0f MB  %u bounces  noise %.2f %%  %.1f s\n",
         r->surfels, r->hidden_surfels, r->records, (double)r->rays * 1e-6, (double)r->links * 1e-6,
         (double)r->bytes * 1e-6, r->bounces, 100 * r->noise, r->seconds);
}

int study_light_quality(int argc, char **argv) {
  olx_scene *scene = NULL;
  if (olx_scene_load(argv[1], &scene) != OLX_OK) return library_failure(NAME);
  solved_probes probes;
  if (solved_probes_load(scene, argc > 2 ? argv[2] : "-", &probes) != OLX_OK) return library_failure(NAME);
  olx_scene_light_settings s = olx_scene_light_settings_default();
  if (argc > 3) s.noise = (float)atof(argv[3]);
  if (argc > 4) s.spacing = (float)atof(argv[4]);
  if (argc > 5) s.map_size = (uint32_t)atoi(argv[5]);
  s.bounces = argc > 8 ? (uint32_t)atoi(argv[8]) : 4;
  const uint32_t points = argc > 6 ? (uint32_t)atoi(argv[6]) : 2000;
  job j = {.scene = scene,
           .bounces = s.bounces,
           .points = calloc(points, sizeof *j.points),
           .paths = argc > 7 ? (uint32_t)atoi(argv[7]) : 512};
  for (uint32_t i = 0; i < scene->camera_count && i < 64; i++)
    if (olx_camera_frame_make(&scene->cameras[i], 16, 9, &j.frame[j.frames]) == OLX_OK) j.frames++;
  olx_scene_light *light[2];
  for (uint32_t k = 0; k < 2; k++) {
    s.seed = k;
    if (olx_scene_light_create(scene, &s, probes.positions, probes.flags, probes.count, &light[k]) != OLX_OK)
      return library_failure(NAME);
    const olx_scene_light_report r = olx_scene_light_describe(light[k]);
    if (k == 0) print_report(&r), fflush(stdout);
    j.light[k] = light[k];
  }
  olx_parallel_for(points, 0, make_point, &j, NULL, 0);
  const double start = olx_thread_seconds();
  for (uint32_t i = 0; i < points; i++) look_up(&j, i);
  printf("%.2f us a look-up\n", 1e6 * (olx_thread_seconds() - start) / (2.0 * points));
  report_points(&j, points);
  report_part(&j, points, true);
  report_part(&j, points, false);
  report_rays(&j, points);
  return 0;
}
