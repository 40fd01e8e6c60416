// Measures what looking up wide lobes is worth: glossy-wide SCENE FIELD.olx WIDTH HEIGHT SPP PATHS KEPT [READS...]. It
// renders every camera of the scene by 1, 4 and 16 plain glossy rays a camera sample and with each number of READS, and
// compares `indirect_glossy` with path tracing. Errors include the noise of the field's picture, but not that of the
// reference, of which there are two independent halves.
#include "options.h"
#include "path_reference.h"
#include "studies.h"

#include <octalux/octalux.h>
#include <octalux/render.h>

#include <stdio.h>
#include <stdlib.h>

enum { MOST_WAYS = 16, PLAIN = 3, HALVES = 2 };

typedef struct way {
  uint32_t rays, reads;
  double error, power, difference, light, seconds, traced;
} way;

static void add_pixels(way *w, const olx_image *image, const olx_image truth[HALVES]) {
  const size_t count = (size_t)image->width * image->height * 3;
  const float *found = &image->layers[OLX_LAYER_INDIRECT_GLOSSY]->x,
              *first = &truth[0].layers[OLX_LAYER_INDIRECT_GLOSSY]->x,
              *second = &truth[1].layers[OLX_LAYER_INDIRECT_GLOSSY]->x;
  for (size_t i = 0; i < count; i++) {
    const double f = (double)found[i], a = (double)first[i], b = (double)second[i];
    w->error += (f - a) * (f - b);
    w->power += a * b;
    w->difference += f - 0.5 * (a + b);
    w->light += 0.5 * (a + b);
  }
}

static void print(const char *camera, const way *w) {
  printf("%-12s %2u rays, %3u directions: relative MSE %7.4f, bias %+6.2f %%, glossy pass %6.2f s, %.2f million rays\n",
         camera, w->rays, w->reads, w->error / w->power, 100.0 * w->difference / w->light, w->seconds,
         w->traced * 1e-6);
  fflush(stdout);
}

static bool judge(const olx_scene *scene, const olx_field *field, const olx_camera *camera,
                  olx_render_settings settings, const olx_image truth[HALVES], way *all) {
  olx_image image;
  olx_render_stats stats;
  way w = {.rays = all->rays, .reads = all->reads};
  settings.glossy_samples = w.rays;
  settings.lobe_reads = w.reads;
  if (olx_render(scene, field, camera, &settings, NULL, &image, &stats) != OLX_OK) return false;
  w.seconds = stats.glossy_seconds;
  w.traced = (double)stats.field_rays;
  add_pixels(&w, &image, truth);
  add_pixels(all, &image, truth);
  all->seconds += w.seconds;
  all->traced += w.traced;
  print(camera->name, &w);
  olx_image_free(&image);
  return true;
}

static bool judge_camera(const olx_scene *scene, const olx_field *field, const olx_camera *camera, char **argv,
                         way *ways, uint32_t count) {
  olx_render_settings by_field = olx_render_settings_default(OLX_METHOD_FIELD),
                      by_path = olx_render_settings_default(OLX_METHOD_PATH);
  by_field.width = by_path.width = (uint32_t)atoi(argv[3]);
  by_field.height = by_path.height = (uint32_t)atoi(argv[4]);
  by_field.spp = (uint32_t)atoi(argv[5]);
  by_path.spp = (uint32_t)atoi(argv[6]);
  by_path.bounces = olx_field_describe(field).bounces.count + 1;
  olx_image truth[HALVES] = {0};
  bool fine = true;
  for (uint32_t half = 0; half < HALVES && fine; half++) {
    by_path.seed = half + 1;
    fine = path_reference(scene, camera, &by_path, argv[7], &truth[half]) == OLX_OK;
  }
  for (uint32_t i = 0; i < count && fine; i++) fine = judge(scene, field, camera, by_field, truth, &ways[i]);
  for (uint32_t half = 0; half < HALVES; half++) olx_image_free(&truth[half]);
  return fine;
}

int study_glossy_wide(int argc, char **argv) {
  olx_scene *scene = NULL;
  olx_field *field = NULL;
  way ways[MOST_WAYS] = {{.rays = 1}, {.rays = 4}, {.rays = 16}};
  uint32_t count = PLAIN;
  for (int i = 8; i < argc && count < MOST_WAYS; i++)
    ways[count++] = (way){.rays = 1, .reads = (uint32_t)atoi(argv[i])};
  bool fine = olx_scene_load(argv[1], &scene) == OLX_OK && olx_field_open(argv[2], &field) == OLX_OK;
  const uint32_t cameras = fine ? olx_scene_describe(scene).cameras : 0;
  for (uint32_t c = 0; c < cameras && fine; c++) {
    const olx_camera camera = olx_scene_camera(scene, c);
    fine = judge_camera(scene, field, &camera, argv, ways, count);
  }
  for (uint32_t i = 0; i < count && fine; i++) print("all", &ways[i]);
  if (!fine) library_failure(BENCH_PROGRAM " glossy-wide");
  olx_field_close(field);
  olx_scene_free(scene);
  return fine ? 0 : 1;
}
