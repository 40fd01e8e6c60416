// Measures what the glossy pass of pictures costs on one thread, through several fields or through one in several ways:
// glossy-speed SCENE WIDTH HEIGHT ROUNDS FIELD.olx:TRACER:SELECTOR.... All take turns in every round, picture by
// picture. Prints a Markdown table of medians, whose first line is what the others are compared with.
#include "options.h"
#include "studies.h"

#include <octalux/octalux.h>
#include <octalux/render.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char NAME[] = BENCH_PROGRAM " glossy-speed";

enum { MOST_WAYS = 16, MOST_ROUNDS = 99 };

typedef struct way {
  const char *name;
  olx_field *field;
  olx_sample_settings sample;
  double ns[MOST_ROUNDS]; // nanoseconds per ray
  olx_render_stats stats; // statistics of one round
} way;

// Parses "file.olx:hiz:bricks", and splits the text in place.
static bool open_way(char *text, way *w) {
  static const char *const tracers[] = {"texel", "two-level", "hiz"};
  char *selector = strrchr(text, ':');
  if (!selector) return false;
  *selector++ = 0;
  char *tracer = strrchr(text, ':');
  if (!tracer) return false;
  *tracer++ = 0;
  w->sample = olx_sample_settings_default();
  uint32_t t = 0, s = 0;
  while (t < 3 && strcmp(tracer, tracers[t]) != 0) t++;
  while (s <= OLX_SELECT_BEST && strcmp(selector, olx_select_name((olx_select)s)) != 0) s++;
  if (t == 3 || s > OLX_SELECT_BEST) return false;
  w->sample.tracer = (olx_tracer)t;
  w->sample.select = (olx_select)s;
  const char *file = strrchr(text, '/');
  w->name = file ? file + 1 : text;
  if (olx_field_open(text, &w->field) == OLX_OK) return true;
  library_failure(NAME);
  return false;
}

static void add(olx_render_stats *sum, const olx_render_stats *one) {
  sum->glossy_seconds += one->glossy_seconds;
  sum->field_rays += one->field_rays;
  sum->field_steps += one->field_steps;
  sum->field_probes += one->field_probes;
  sum->field_unresolved += one->field_unresolved;
}

static bool render(const olx_scene *scene, way *w, const olx_camera *camera, uint32_t width, uint32_t height) {
  olx_render_settings settings = olx_render_settings_default(OLX_METHOD_FIELD);
  settings.width = width;
  settings.height = height;
  settings.spp = settings.glossy_samples = settings.threads = 1;
  settings.sample = w->sample;
  olx_image image;
  olx_render_stats stats;
  if (olx_render(scene, w->field, camera, &settings, NULL, &image, &stats) != OLX_OK) {
    library_failure(NAME);
    return false;
  }
  olx_image_free(&image);
  add(&w->stats, &stats);
  return true;
}

static int ascending(const void *a, const void *b) {
  const double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

static double median(double *values, uint32_t count) {
  qsort(values, count, sizeof *values, ascending);
  return count % 2 ? values[count / 2] : 0.5 * (values[count / 2 - 1] + values[count / 2]);
}

static void print_ways(way *ways, uint32_t count, uint32_t rounds) {
  static const char *const tracers[] = {"texel", "two-level", "hiz"};
  double first = 0.0;
  printf("| field | tracer | selector | ns a ray | times as fast | steps a ray | probes a ray | unresolved |\n");
  printf("| --- | --- | --- | --- | --- | --- | --- | --- |\n");
  for (uint32_t i = 0; i < count; i++) {
    const way *w = &ways[i];
    const double ns = median(ways[i].ns, rounds), rays = (double)w->stats.field_rays;
    if (i == 0) first = ns;
    printf("| %s | %s | %s | %.0f | %.2f | %.1f | %.2f | %.2f %% |\n", w->name, tracers[w->sample.tracer],
           olx_select_name(w->sample.select), ns, first / ns, (double)w->stats.field_steps / rays,
           (double)w->stats.field_probes / rays, 100.0 * (double)w->stats.field_unresolved / rays);
  }
}

int study_glossy_speed(int argc, char **argv) {
  const long width = strtol(argv[2], NULL, 10), height = strtol(argv[3], NULL, 10), rounds = strtol(argv[4], NULL, 10);
  const uint32_t count = (uint32_t)argc - 5;
  static way ways[MOST_WAYS];
  bool fine = count <= MOST_WAYS && width > 0 && height > 0 && rounds > 0 && rounds <= MOST_ROUNDS;
  for (uint32_t i = 0; fine && i < count; i++) fine = open_way(argv[5 + i], &ways[i]);
  if (!fine) return usage_error(NAME, "takes SCENE WIDTH HEIGHT ROUNDS FIELD.olx:texel|two-level|hiz:SELECTOR...");
  olx_scene *scene;
  if (olx_scene_load(argv[1], &scene) != OLX_OK) return library_failure(NAME);
  const uint32_t cameras = olx_scene_describe(scene).cameras;
  for (long round = -1; round < rounds && fine; round++) { // the first round loads files into memory and is not counted
    for (uint32_t i = 0; i < count; i++) ways[i].stats = (olx_render_stats){0};
    for (uint32_t c = 0; c < cameras && fine; c++) {
      const olx_camera camera = olx_scene_camera(scene, c);
      for (uint32_t i = 0; i < count && fine; i++)
        fine = render(scene, &ways[i], &camera, (uint32_t)width, (uint32_t)height);
    }
    for (uint32_t i = 0; round >= 0 && i < count; i++) {
      ways[i].ns[round] = 1e9 * ways[i].stats.glossy_seconds / (double)ways[i].stats.field_rays;
    }
  }
  if (fine) print_ways(ways, count, (uint32_t)rounds);
  for (uint32_t i = 0; i < count; i++) olx_field_close(ways[i].field);
  olx_scene_free(scene);
  return fine ? 0 : 1;
}
