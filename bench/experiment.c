// Runs experiments, and provides what they share: scenes that may be absent, references that are path traced once per
// run, and fields.
#include "experiment.h"

#include "clock.h"
#include "report.h"
#include "studies.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { PATH_TEXT = 4096 };

void bench_progress(const bench *b, const char *format, ...) {
  if (!b->told) return;
  va_list arguments;
  va_start(arguments, format);
  fprintf(stderr, BENCH_PROGRAM ": %s: ", b->experiment->name);
  vfprintf(stderr, format, arguments);
  fputc('\n', stderr);
  va_end(arguments);
}

static bool is_builtin(const char *name) { return strncmp(name, "builtin:", 8) == 0; }

const char *bench_scene_title(const char *name) { return is_builtin(name) ? name + 8 : name; }

olx_result bench_scene(bench *b, const char *name, olx_scene **scene) {
  *scene = NULL;
  for (uint32_t i = 0; i < b->scene_count; ++i) {
    if (strcmp(b->scenes[i].name, name) == 0) *scene = b->scenes[i].scene;
  }
  if (*scene) return OLX_OK;
  char path[PATH_TEXT];
  snprintf(path, sizeof path, is_builtin(name) ? "%.0s%s" : "%s/%s.json", b->options->folder, name);
  const olx_result result = olx_scene_load(path, scene);
  if (result == OLX_ERROR_FILE && !is_builtin(name)) {
    findings_skip(&b->found, name, olx_last_error());
    fprintf(stderr, BENCH_PROGRAM ": %s: %s is left out: %s\n", b->experiment->name, name, olx_last_error());
    return OLX_OK;
  }
  if (result != OLX_OK) return result;
  if (b->scene_count == BENCH_SCENES) {
    olx_scene_free(b->scenes[0].scene);
    memmove(b->scenes, b->scenes + 1, sizeof *b->scenes * --b->scene_count);
  }
  b->scenes[b->scene_count].name = name;
  b->scenes[b->scene_count++].scene = *scene;
  return OLX_OK;
}

bool bench_leaves_out(bench *b, const char *name) {
  if (!b->options->quick || is_builtin(name)) return false;
  findings_skip(&b->found, name, "--quick keeps to built-in scenes");
  return true;
}

bool bench_listed(const char *names, const char *name) {
  const size_t length = strlen(name);
  for (const char *at = names; at; at = strchr(at, ',')) {
    at += *at == ',';
    if (strncmp(at, name, length) == 0 && (at[length] == ',' || !at[length])) return true;
  }
  return false;
}

bool bench_names(const bench_options *o, const char *title) { return !o->only || bench_listed(o->only, title); }

static olx_render_settings sized(const bench *b, olx_method method) {
  const bench_options *o = b->options;
  olx_render_settings settings = olx_render_settings_default(method);
  settings.diffuse = OLX_DIFFUSE_IRRADIANCE; // as in the papers
  settings.width = o->size[0] ? o->size[0] : o->quick ? 96 : 240;
  settings.height = o->size[0] ? o->size[1] : o->quick ? 72 : 180;
  settings.threads = o->threads;
  return settings;
}

olx_render_settings bench_path_settings(const bench *b) {
  olx_render_settings settings = sized(b, OLX_METHOD_PATH);
  settings.spp = b->options->spp ? b->options->spp : b->options->quick ? 32 : 64;
  return settings;
}

uint32_t bench_bounces(const bench *b) { return b->options->quick ? 1 : 3; }

uint32_t bench_spp(const bench *b) { return b->options->quick ? 2 : 4; }

olx_render_settings bench_field_settings(const bench *b) {
  olx_render_settings settings = sized(b, OLX_METHOD_FIELD);
  settings.spp = bench_spp(b);
  return settings;
}

olx_render_settings bench_cage_settings(const bench *b) {
  olx_render_settings settings = bench_field_settings(b);
  settings.sample.select = OLX_SELECT_CAGE;
  return settings;
}

// The parameters of a reference. They are compared as bytes, so every byte must be set.
typedef struct reference_key {
  uint64_t scene_hash;
  olx_camera cameras[BENCH_CAMERAS];
  uint32_t camera_count, width, height, spp, bounces, centered;
} reference_key;

struct bench_reference_entry {
  reference_key key;
  bench_images images;
  bench_reference_entry *next;
};

static void fill_key(reference_key *key, const olx_scene *scene, const olx_camera *cameras, uint32_t count,
                     const olx_render_settings *settings, uint32_t bounces) {
  memset(key, 0, sizeof *key);
  key->scene_hash = olx_scene_describe(scene).hash;
  for (uint32_t c = 0; c < count; ++c) {
    key->cameras[c].eye = cameras[c].eye;
    key->cameras[c].target = cameras[c].target;
    key->cameras[c].up = cameras[c].up;
    key->cameras[c].fov_y_degrees = cameras[c].fov_y_degrees;
  }
  key->camera_count = count;
  key->width = settings->width;
  key->height = settings->height;
  key->spp = settings->spp;
  key->bounces = bounces;
  key->centered = settings->centered;
}

olx_result bench_reference(bench *b, const olx_scene *scene, const olx_camera *cameras, uint32_t count,
                           const olx_render_settings *settings, uint32_t bounces, bench_images **references) {
  bench_reference_entry *entry = calloc(1, sizeof *entry);
  if (!entry) return OLX_ERROR_MEMORY;
  fill_key(&entry->key, scene, cameras, count, settings, bounces);
  for (bench_reference_entry *known = b->references; known; known = known->next) {
    if (memcmp(&known->key, &entry->key, sizeof known->key) != 0) continue;
    free(entry);
    *references = &known->images;
    return OLX_OK;
  }
  entry->next = b->references;
  b->references = entry;
  *references = &entry->images;
  bench_way way = {.settings = *settings};
  way.settings.bounces = bounces;
  bench_progress(b, "path tracing, %u cameras, %u x %u pixels, twice %u paths", count, settings->width,
                 settings->height, settings->spp);
  return bench_images_render(scene, cameras, count, &way, 0, &b->progress, &entry->images);
}

static void free_references(bench *b) {
  while (b->references) {
    bench_reference_entry *entry = b->references;
    b->references = entry->next;
    bench_images_free(&entry->images);
    free(entry);
  }
}

bench_bake bench_bake_settings(const bench *b, bool classic) {
  const bool quick = b->options->quick;
  return (bench_bake){.irradiance_size = quick ? 16 : 64,
                      .light_samples = 2,
                      .classic_size = !classic ? 0
                                      : quick  ? 32
                                               : 128,
                      .noise = quick ? BENCH_ROUGH_NOISE : 0.0f,
                      .bounces = bench_bounces(b)};
}

// Returns whether bench_scene loaded the scene from a description, not by the name of a built-in one.
static bool is_model(const bench *b, const olx_scene *scene) {
  for (uint32_t i = 0; i < b->scene_count; ++i) {
    if (b->scenes[i].scene == scene) return !is_builtin(b->scenes[i].name);
  }
  return false;
}

olx_result bench_bake_field(bench *b, const olx_scene *scene, const bench_probes *probes, const bench_bake *bake,
                            bench_field *made) {
  bench_progress(b, "baking %s", bench_probes_name(probes).text);
  bench_bake own = *bake;
  if (!(own.noise > 0.0f) && is_model(b, scene)) own.noise = BENCH_MODEL_NOISE;
  own.threads = b->options->threads;
  own.rough = b->options->quick;
  return bench_field_make(scene, probes, &own, &b->folder, b->fields++, &b->progress, made);
}

olx_result bench_pictures(bench *b, const olx_scene *scene, const olx_camera *cameras, uint32_t count,
                          const bench_way *way, bench_images *images) {
  bench_progress(b, "rendering %s", way->name);
  return bench_images_render(scene, cameras, count, way, 1, &b->progress, images);
}

void *bench_shared(bench *b, size_t size_bytes, void (*release)(void *data)) {
  for (uint32_t i = 0; i < b->shared_count; ++i) {
    if (b->shared[i].release == release) return b->shared[i].data;
  }
  void *data = b->shared_count < BENCH_SHARED ? calloc(1, size_bytes) : NULL;
  if (!data) return NULL;
  b->shared[b->shared_count].data = data;
  b->shared[b->shared_count++].release = release;
  return data;
}

static void free_shared(bench *b) {
  while (b->shared_count > 0) {
    --b->shared_count;
    b->shared[b->shared_count].release(b->shared[b->shared_count].data);
    free(b->shared[b->shared_count].data);
  }
}

bool bench_open(bench *b, const bench_options *options, progress_line *line) {
  *b = (bench){.options = options, .progress = progress_of(line), .told = options->progress || line->shown};
  return bench_folder_make(&b->folder);
}

void bench_close(bench *b) {
  free_shared(b);
  free_references(b);
  bench_folder_remove(&b->folder);
}

olx_result bench_run(bench *b, const experiment *e, cJSON *section) {
  const double start = clock_seconds(CLOCK_MONOTONIC), spent = clock_seconds(CLOCK_PROCESS_CPUTIME_ID);
  b->experiment = e;
  b->section = section;
  b->found = (findings){.table_count = 0};
  bench_progress(b, "begins");
  olx_result result = e->run(b);
  while (b->scene_count > 0) olx_scene_free(b->scenes[--b->scene_count].scene);
  b->found.seconds = clock_seconds(CLOCK_MONOTONIC) - start;
  b->found.processor_seconds = clock_seconds(CLOCK_PROCESS_CPUTIME_ID) - spent;
  if (result == OLX_OK && b->found.exhausted) result = OLX_ERROR_MEMORY;
  return result;
}
