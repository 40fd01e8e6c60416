// Measures how far relit light is from a fresh bake, bounce by bounce, and what of it comes from each step of
// relighting.
//
//   relight-causes SCENE MOVED CAMERA [MAP] [NOISE] [X Y Z]
//
// MOVED is SCENE with other lights; X Y Z are the probes along each axis. SCENE is baked for relighting and relit by
// the lights of MOVED, which is baked with all bounces and with one. Everything is done twice, with different random
// numbers: products of the two differences leave out noise, which is printed beside them. The light of a solution of
// MOVED then replaces that of relit surfels, step by step. Light is compared at surfaces that the camera sees.
#include "bake/capture/shade_batch.h"
#include "core/result.h"
#include "light/scene_light.h"
#include "options.h"
#include "relight/relighter.h"
#include "relight/relit_tiles.h"
#include "render/camera.h"
#include "scene/bvh.h"
#include "studies.h"

#include <octalux/bake.h>
#include <octalux/scene.h>

#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

enum { WIDTH = 96, HEIGHT = 72, MOST_POINTS = WIDTH * HEIGHT, FRAMES = 60, MOST_LIGHTS = 64 };

static const char NAME[] = BENCH_PROGRAM " relight-causes";

typedef struct study {
  olx_scene *scene, *moved;
  olx_camera camera;
  olx_bake_settings settings;
  olx_surface points[MOST_POINTS];
  bool stored[MOST_POINTS]; // light is stored for the point's surface; elsewhere it is the volume's
  uint32_t count;
} study;

// The luminance of irradiance at each point, W/m^2.
typedef struct picture {
  double light[MOST_POINTS];
} picture;

static olx_result bake(const study *s, const olx_scene *scene, uint32_t bounces, uint32_t seed, olx_field **field) {
  char path[] = "/tmp/octalux-relight-XXXXXX";
  const int file = mkstemp(path);
  olx_bake_settings settings = s->settings;
  settings.bounces = bounces;
  settings.seed = seed;
  settings.relight = true;
  if (file >= 0) close(file);
  olx_result result = olx_bake(scene, &settings, path, NULL, NULL);
  if (result == OLX_OK) result = olx_field_open(path, field);
  unlink(path); // the file stays mapped
  return result;
}

static void find_points(study *s) {
  olx_camera_frame frame;
  if (olx_camera_frame_make(&s->camera, WIDTH, HEIGHT, &frame) != OLX_OK) return;
  for (uint32_t i = 0; i < MOST_POINTS; i++) {
    const float x = ((float)(i % WIDTH) + 0.5f) / WIDTH, y = ((float)(i / WIDTH) + 0.5f) / HEIGHT;
    const olx_ray ray = {frame.eye, olx_camera_direction(&frame, x, y), 0.0f, INFINITY};
    const olx_ray_hit hit = olx_bvh_intersect(s->scene->bvh, &ray);
    if (hit.triangle == OLX_NO_HIT) continue;
    olx_surface *p = &s->points[s->count++];
    *p = olx_surface_at(s->scene, &hit, ray.direction);
    p->shading_normal = olx_surface_vertex_normal(s->scene, &hit, p);
  }
}

static void look(const study *s, const olx_field *field, picture *p) {
  const olx_sample_settings sample = olx_sample_settings_default();
  for (uint32_t i = 0; i < s->count; i++) {
    const olx_surface *at = &s->points[i];
    const olx_vec3 view = olx_normalize(olx_sub(s->camera.eye, at->position));
    p->light[i] = (double)olx_luminance(
        olx_surface_irradiance(field, &sample, at->position, at->geometric_normal, at->geometric_normal, view));
  }
}

// Finds the points whose light is stored: they have light in a field without a volume.
static void find_stored(study *s, const olx_field *field) {
  olx_field alone = *field;
  picture *p = calloc(1, sizeof *p);
  alone.volume = (olx_volume){0};
  alone.info.volume.probe_count = 0;
  if (p) look(s, &alone, p);
  for (uint32_t i = 0; p && i < s->count; i++) s->stored[i] = p->light[i] > 0.0;
  free(p);
}

// Lights all texels from the surfels' present light, and looks at them.
static olx_result interpolate(const study *s, olx_relight *r, picture *p) {
  olx_relit_tiles all;
  olx_relit_tile *tiles = NULL;
  OLX_TRY(olx_relit_tiles_create(r->source, &r->settings, &all));
  tiles = calloc(all.count, sizeof *tiles);
  for (uint32_t i = 0; tiles && i < all.count; i++) tiles[i] = all.states[i].tile;
  const olx_relit_tile_turns turns = {tiles, tiles ? all.count : 0, 0, all.side};
  olx_relit_light_tiles(&r->maps, &r->direct, r->surfels.irradiance, &turns);
  olx_relit_tiles_free(&all);
  free(tiles);
  look(s, &r->field, p);
  return OLX_OK;
}

// Carries direct light alone over the links.
static void first_bounce(olx_relight *r) {
  const uint32_t count = r->source->relight.header->surfels;
  const olx_relit_link_turns all = {.count = count, .ends = true, .shines = true};
  double change, sum;
  for (uint32_t i = 0; i < count; i++) r->surfels.irradiance[i] = olx_splat(0.0f);
  olx_relit_bounce(&r->surfels, 0, &all, &change, &sum);
}

static olx_result relight(const study *s, const olx_field *field, olx_relight **r) {
  olx_relight_settings settings = olx_relight_settings_default();
  olx_light lights[MOST_LIGHTS];
  uint32_t count;
  settings.occlusion = olx_scene_occlusion;
  settings.user = s->scene;
  OLX_TRY(olx_scene_relight_lights(s->moved, lights, MOST_LIGHTS, &count));
  OLX_TRY(olx_relight_create(field, &settings, r));
  OLX_TRY(olx_relight_set_lights(*r, lights, count));
  olx_relight_stats stats = {.awake = 1};
  for (uint32_t i = 0; i < FRAMES && stats.awake; i++) OLX_TRY(olx_relight_frame(*r, s->camera.eye, &stats));
  return OLX_OK;
}

// What is compared, with two seeds.
typedef struct pair {
  picture seed[2];
} pair;

// Sums over points whose light is stored, or over the others.
typedef struct sums {
  double off, all, product, relit, baked, light, count;
} sums;

static sums sum_up(const study *s, const pair *relit, const pair *baked, bool stored) {
  sums t = {0};
  for (uint32_t i = 0; i < s->count; i++) {
    if (s->stored[i] != stored) continue;
    const double r[] = {relit->seed[0].light[i], relit->seed[1].light[i]},
                 f[] = {baked->seed[0].light[i], baked->seed[1].light[i]}, a = r[0] - f[0], b = r[1] - f[1];
    t.off += 0.5 * (a + b);
    t.all += 0.5 * (a * a + b * b);
    t.product += a * b;
    t.relit += 0.5 * (r[0] - r[1]) * (r[0] - r[1]);
    t.baked += 0.5 * (f[0] - f[1]) * (f[0] - f[1]);
    t.light += 0.5 * (f[0] + f[1]);
    t.count += 1.0;
  }
  return t;
}

// Prints the differences of relit and baked light at stored or other points, as shares of the mean of `all` light
// there.
static void compare(const study *s, const char *what, const pair *relit, const pair *baked, const pair *all,
                    bool stored) {
  const sums t = sum_up(s, relit, baked, stored);
  const double mean = sum_up(s, all, all, stored).light / t.count;
  if (t.count <= 0.0) return;
  printf("%-14s mean off %+6.2f %%  RMS %6.2f %%  without noise %6.2f %%  noise: relit %6.2f %%, baked %6.2f %%\n",
         what, 100.0 * t.off / t.count / mean, 100.0 * sqrt(t.all / t.count) / mean,
         (t.product < 0.0 ? -100.0 : 100.0) * sqrt(fabs(t.product) / t.count) / mean,
         100.0 * sqrt(t.relit / t.count) / mean, 100.0 * sqrt(t.baked / t.count) / mean);
}

static void subtract(const study *s, const pair *a, const pair *b, pair *difference) {
  for (uint32_t k = 0; k < 2; k++) {
    for (uint32_t i = 0; i < s->count; i++) difference->seed[k].light[i] = a->seed[k].light[i] - b->seed[k].light[i];
  }
}

// The pictures of both seeds.
typedef struct pictures {
  pair relit, relit_first, lit_first, exact; // lit_first: of the solution's direct light; exact: of all of its light
  pair baked, baked_first;
  pair relit_later, baked_later;
} pictures;

// Replaces steps of relighting by the solution's, whose surfels must be those of the field.
static olx_result use_solution(const study *s, uint32_t seed, olx_relight *r, pictures *p) {
  const olx_field *field = r->source;
  olx_scene_light_settings settings = olx_scene_light_settings_default();
  olx_scene_light *light = NULL;
  settings.bounces = s->settings.bounces + 1;
  settings.noise = s->settings.noise;
  settings.map_size = s->settings.radiance_size;
  olx_shade_context shade;
  olx_shade_context_begin(&shade, s->moved, seed);
  settings.seed = shade.seed; // as in a bake
  OLX_TRY(olx_scene_light_create(s->moved, &settings, field->probe_positions, field->probe_flags,
                                 field->info.probes.count, &light));
  const olx_scene_light_parts parts = olx_scene_light_open(light);
  const uint32_t count = field->relight.header->surfels;
  printf("%u surfels, %.1f links each; the solution has %u\n", count, (double)field->relight.header->links / count,
         parts.surfels->count);
  if (parts.surfels->count != count) printf("(no comparison with the solution, whose surfels are others)\n");
  else {
    for (uint32_t i = 0; i < count; i++) r->surfels.direct[i] = parts.direct.all[i];
    first_bounce(r);
    OLX_TRY(interpolate(s, r, &p->lit_first.seed[seed]));
    for (uint32_t i = 0; i < count; i++) r->surfels.irradiance[i] = parts.irradiance[i];
    OLX_TRY(interpolate(s, r, &p->exact.seed[seed]));
  }
  olx_scene_light_free(light);
  return OLX_OK;
}

static olx_result run_seed(study *s, uint32_t seed, pictures *p) {
  olx_field *field = NULL, *all = NULL, *first = NULL;
  olx_relight *r = NULL;
  olx_result result = bake(s, s->scene, s->settings.bounces, seed, &field);
  if (result == OLX_OK) result = bake(s, s->moved, s->settings.bounces, seed, &all);
  if (result == OLX_OK) result = bake(s, s->moved, 0, seed, &first);
  if (result == OLX_OK) result = relight(s, field, &r);
  if (result == OLX_OK && seed == 0) find_stored(s, all);
  if (result == OLX_OK) {
    look(s, all, &p->baked.seed[seed]);
    look(s, first, &p->baked_first.seed[seed]);
    look(s, &r->field, &p->relit.seed[seed]);
    first_bounce(r);
    result = interpolate(s, r, &p->relit_first.seed[seed]);
  }
  if (result == OLX_OK) result = use_solution(s, seed, r, p);
  olx_relight_free(r);
  olx_field_close(field);
  olx_field_close(all);
  olx_field_close(first);
  return result;
}

static void report(const study *s, pictures *p) {
  const pair *all = &p->baked;
  const double stored = sum_up(s, all, all, true).count;
  subtract(s, &p->relit, &p->relit_first, &p->relit_later);
  subtract(s, &p->baked, &p->baked_first, &p->baked_later);
  printf("%.2f %% of the points have stored light; shares of the mean of fresh bakes there:\n",
         100.0 * stored / s->count);
  compare(s, "all", &p->relit, all, all, true);
  compare(s, "first bounce", &p->relit_first, &p->baked_first, all, true);
  compare(s, "later bounces", &p->relit_later, &p->baked_later, all, true);
  compare(s, "exact direct", &p->lit_first, &p->baked_first, all, true);
  compare(s, "exact surfels", &p->exact, all, all, true);
  if (stored == (double)s->count) return;
  printf("at the other points, which take the light of the volume:\n");
  compare(s, "all", &p->relit, all, all, false);
}

int study_relight_causes(int argc, char **argv) {
  study *s = calloc(1, sizeof *s);
  pictures *p = calloc(1, sizeof *p);
  if (!s || !p) return failure(NAME, "out of memory");
  olx_result result = olx_scene_load(argv[1], &s->scene);
  if (result == OLX_OK) result = olx_scene_load(argv[2], &s->moved);
  if (result == OLX_OK) result = olx_scene_find_camera(s->scene, argv[3], &s->camera);
  if (result == OLX_OK) {
    s->settings = olx_bake_settings_default(s->scene);
    if (argc > 4) s->settings.radiance_size = (uint32_t)atoi(argv[4]);
    if (argc > 5) s->settings.noise = (float)atof(argv[5]);
    const uint32_t counts[3] = {argc > 8 ? (uint32_t)atoi(argv[6]) : 0, argc > 8 ? (uint32_t)atoi(argv[7]) : 0,
                                argc > 8 ? (uint32_t)atoi(argv[8]) : 0};
    if (counts[2]) result = olx_scene_probe_grid(s->scene, counts, &s->settings.grid);
    find_points(s);
  }
  for (uint32_t seed = 0; seed < 2 && result == OLX_OK; seed++) result = run_seed(s, seed, p);
  if (result == OLX_OK) report(s, p);
  olx_scene_free(s->scene);
  olx_scene_free(s->moved);
  free(s);
  free(p);
  return result == OLX_OK ? EXIT_DONE : library_failure(NAME);
}
