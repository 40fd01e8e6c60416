// Measures how far glossy light through a field is from path tracing, and what its pass costs, with hits shaded and
// with stored radiance: glossy-quality SCENE FIELD.olx WIDTH HEIGHT SPP PATHS KEPT. It renders every camera of the
// scene and keeps path-traced pictures for the next time, in files that begin with KEPT. Errors are products of two
// independent halves, so noise adds nothing to them.
#include "options.h"
#include "path_reference.h"
#include "studies.h"

#include <octalux/octalux.h>
#include <octalux/render.h>

#include <stdio.h>
#include <stdlib.h>

static const char NAME[] = BENCH_PROGRAM " glossy-quality";

enum { HALVES = 2, WAYS = 2 };

static const char *const way_names[WAYS] = {"shaded", "stored"};

typedef struct totals {
  double error, power, difference, light, seconds, rays, unresolved;
} totals;

static bool failed(olx_result result) {
  if (result != OLX_OK) library_failure(NAME);
  return result != OLX_OK;
}

static void add_pixels(totals *t, const olx_image a[HALVES], const olx_image b[HALVES]) {
  const size_t count = (size_t)a[0].width * a[0].height * 3;
  const float *p[4] = {&a[0].layers[OLX_LAYER_INDIRECT_GLOSSY]->x, &a[1].layers[OLX_LAYER_INDIRECT_GLOSSY]->x,
                       &b[0].layers[OLX_LAYER_INDIRECT_GLOSSY]->x, &b[1].layers[OLX_LAYER_INDIRECT_GLOSSY]->x};
  for (size_t i = 0; i < count; i++) {
    const double v[4] = {(double)p[0][i], (double)p[1][i], (double)p[2][i], (double)p[3][i]};
    t->error += (v[0] - v[2]) * (v[1] - v[3]);
    t->power += v[2] * v[3];
    t->difference += v[0] + v[1] - v[2] - v[3];
    t->light += v[2] + v[3];
  }
}

static void print(const char *camera, const char *way, const totals *t) {
  printf("%-12s %-8s relative MSE %7.4f, bias %+6.2f %%, glossy pass %6.2f s, %.2f million rays, %.2f %% unresolved\n",
         camera, way, t->error / t->power, 100.0 * t->difference / t->light, t->seconds, t->rays * 1e-6,
         100.0 * t->unresolved / t->rays);
  fflush(stdout);
}

static bool judge(const olx_scene *scene, const olx_field *field, const olx_camera *camera,
                  olx_render_settings settings, uint32_t way, const olx_image truth[HALVES], totals *all) {
  olx_image images[HALVES];
  totals t = {0};
  settings.sample.hits = (olx_hits)way;
  for (uint32_t half = 0; half < HALVES; half++) {
    olx_render_stats stats;
    settings.seed = half + 1;
    if (failed(olx_render(scene, field, camera, &settings, NULL, &images[half], &stats))) return false;
    t.seconds += stats.glossy_seconds;
    t.rays += (double)stats.field_rays;
    t.unresolved += (double)stats.field_unresolved;
  }
  add_pixels(&t, images, truth);
  add_pixels(all, images, truth);
  all->seconds += t.seconds;
  all->rays += t.rays;
  all->unresolved += t.unresolved;
  print(camera->name, way_names[way], &t);
  for (uint32_t half = 0; half < HALVES; half++) olx_image_free(&images[half]);
  return true;
}

int study_glossy_quality(int argc, char **argv) {
  (void)argc;
  olx_scene *scene = NULL;
  olx_field *field = NULL;
  if (failed(olx_scene_load(argv[1], &scene)) || failed(olx_field_open(argv[2], &field))) return 1;
  olx_render_settings by_field = olx_render_settings_default(OLX_METHOD_FIELD),
                      by_path = olx_render_settings_default(OLX_METHOD_PATH);
  by_field.width = by_path.width = (uint32_t)atoi(argv[3]);
  by_field.height = by_path.height = (uint32_t)atoi(argv[4]);
  by_field.spp = (uint32_t)atoi(argv[5]);
  by_path.spp = (uint32_t)atoi(argv[6]);
  by_path.bounces = olx_field_describe(field).bounces.count + 1;
  totals all[WAYS] = {0};
  bool fine = true;
  const uint32_t cameras = olx_scene_describe(scene).cameras;
  for (uint32_t c = 0; c < cameras && fine; c++) {
    const olx_camera camera = olx_scene_camera(scene, c);
    olx_image truth[HALVES] = {0};
    for (uint32_t half = 0; half < HALVES && fine; half++) {
      by_path.seed = half + 1;
      fine = !failed(path_reference(scene, &camera, &by_path, argv[7], &truth[half]));
    }
    for (uint32_t way = 0; way < WAYS && fine; way++) {
      fine = judge(scene, field, &camera, by_field, way, truth, &all[way]);
    }
    for (uint32_t half = 0; half < HALVES; half++) olx_image_free(&truth[half]);
  }
  for (uint32_t way = 0; way < WAYS && fine; way++) print("all", way_names[way], &all[way]);
  olx_field_close(field);
  olx_scene_free(scene);
  return fine ? 0 : 1;
}
