// Runs experiments, and lends them what they share: scenes that may be absent, references that are path traced once in
// a run, fields, and pictures for the report.
#include "experiment.h"

#include "clock.h"
#include "html_report.h"
#include "report.h"
#include "studies.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { PATH_TEXT = 4096 };

void bench_tell(const bench *b, const char *format, ...) {
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

static olx_render_settings sized(const bench *b, olx_method method) {
  const bench_options *o = b->options;
  olx_render_settings settings = olx_render_settings_default(method);
  settings.diffuse = OLX_DIFFUSE_IRRADIANCE; // as the papers have it
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

// What a reference depends on; compared as bytes, so every byte of it is set.
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
  bench_tell(b, "path tracing, %u cameras, %u x %u pixels, twice %u paths", count, settings->width, settings->height,
             settings->spp);
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

olx_result bench_bake_field(bench *b, const olx_scene *scene, const bench_probes *probes, const bench_bake *bake,
                            bench_field *made) {
  bench_tell(b, "baking %s", bench_probes_name(probes).text);
  bench_bake own = *bake;
  own.threads = b->options->threads;
  own.rough = b->options->quick;
  return bench_field_make(scene, probes, &own, &b->folder, b->fields++, &b->progress, made);
}

olx_result bench_pictures(bench *b, const olx_scene *scene, const olx_camera *cameras, uint32_t count,
                          const bench_way *way, bench_images *images) {
  bench_tell(b, "rendering %s", way->name);
  return bench_images_render(scene, cameras, count, way, 1, &b->progress, images);
}

static olx_layer layer_of(bench_light light) {
  static const olx_layer layers[] = {[BENCH_DIFFUSE] = OLX_LAYER_INDIRECT_DIFFUSE,
                                     [BENCH_GLOSSY] = OLX_LAYER_INDIRECT_GLOSSY,
                                     [BENCH_INDIRECT] = OLX_LAYER_BEAUTY,
                                     [BENCH_BEAUTY] = OLX_LAYER_BEAUTY};
  return layers[light];
}

// Indirect light alone is dim: a power of two brings it to where it can be looked at. Bright places count more than dark
// ones, since a layer may be black where nothing is glossy.
static float exposure_for(const olx_image *reference, olx_layer layer) {
  if (layer == OLX_LAYER_BEAUTY) return 1.0f;
  const size_t pixels = (size_t)reference->width * reference->height;
  double sum = 0.0, squares = 0.0;
  for (size_t i = 0; i < pixels; ++i) {
    const olx_vec3 light = reference->layers[layer][i];
    const double mean = ((double)light.x + (double)light.y + (double)light.z) / 3.0;
    sum += mean;
    squares += mean * mean;
  }
  return sum > 0.0 ? (float)exp2(fmin(fmax(rint(log2(0.4 * sum / squares)), 0.0), 16.0)) : 1.0f;
}

static olx_result look(bench *b, const olx_image *image, const olx_image *reference, olx_layer layer, float *flip_map,
                       float *exposure, olx_perceptual *perceptual) {
  if (!image || !reference) return OLX_ERROR_MEMORY;
  olx_perceptual_settings settings = olx_perceptual_settings_default();
  settings.exposure = *exposure = exposure_for(reference, layer);
  settings.threads = b->options->threads;
  return olx_compare_perceptual(image, reference, layer, &settings, flip_map, perceptual);
}

olx_result bench_compare(bench *b, bench_images *images, bench_images *references, bench_light light, uint32_t camera,
                         bench_quality *quality) {
  *quality = (bench_quality){.error = bench_error_of(images, references, light, camera), .ssim = NAN, .flip = NAN};
  if (light == BENCH_INDIRECT || camera == BENCH_CAMERAS) return OLX_OK;
  olx_perceptual perceptual;
  const olx_result result = look(b, bench_images_mean(images, camera), bench_images_mean(references, camera),
                                 layer_of(light), NULL, &quality->exposure, &perceptual);
  quality->ssim = perceptual.ssim;
  quality->flip = perceptual.flip;
  return result;
}

// "mcguire-leaks-fig-10-field-indirect_diffuse.png", with nothing in it that a file name should not have.
static olx_result save_picture(const bench *b, const char *view, const char *way, const olx_image *image,
                               olx_layer layer, float exposure) {
  char path[PATH_TEXT];
  snprintf(path, sizeof path, "%s/%s-%s-%s-%s.png", b->options->images, b->experiment->name, view, way,
           olx_layer_name(layer));
  for (char *c = path + strlen(b->options->images) + 1; *c; ++c) {
    const bool plain = strchr("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_.", *c) != NULL;
    if (!plain) *c = '_';
  }
  return olx_image_save_layer_png(image, layer, exposure, path);
}

static olx_result add_way(bench *b, cJSON *frame, const bench_shown *way, const olx_image *reference, olx_layer layer) {
  const olx_image *image = bench_images_mean(way->images, way->camera);
  const size_t pixels = (size_t)reference->width * reference->height;
  float *flip_map = malloc(pixels * sizeof *flip_map), exposure;
  olx_perceptual perceptual;
  olx_result result = flip_map ? look(b, image, reference, layer, flip_map, &exposure, &perceptual) : OLX_ERROR_MEMORY;
  if (result == OLX_OK) result = html_report_picture(frame, way->way, image, layer, exposure);
  if (result == OLX_OK) result = html_report_flip(frame, "FLIP", flip_map);
  if (result == OLX_OK) result = html_report_squares(frame, "squared error", image, reference, layer);
  if (result == OLX_OK) html_report_maps_of(frame, 2, way->way);
  free(flip_map);
  return result;
}

static olx_result report_view(bench *b, const char *view, olx_layer layer, const bench_shown *ways, uint32_t count,
                              const olx_image *reference) {
  cJSON *frame = html_report_frame(b->section, view, reference);
  olx_result result = add_way(b, frame, &ways[0], reference, layer);
  // The first two pictures are those that the divider parts.
  if (result == OLX_OK) {
    result = html_report_picture(frame, "path traced", reference, layer, exposure_for(reference, layer));
  }
  for (uint32_t i = 1; i < count && result == OLX_OK; ++i) result = add_way(b, frame, &ways[i], reference, layer);
  return result;
}

olx_result bench_show(bench *b, const char *view, olx_layer layer, const bench_shown *ways, uint32_t count,
                      bench_images *references, uint32_t reference_camera) {
  if (!b->section && !b->options->images) return OLX_OK;
  const olx_image *reference = bench_images_mean(references, reference_camera);
  if (!reference) return OLX_ERROR_MEMORY;
  olx_result result = b->section ? report_view(b, view, layer, ways, count, reference) : OLX_OK;
  if (!b->options->images) return result;
  const float exposure = exposure_for(reference, layer);
  for (uint32_t i = 0; i < count && result == OLX_OK; ++i) {
    const olx_image *image = bench_images_mean(ways[i].images, ways[i].camera);
    result = image ? save_picture(b, view, ways[i].way, image, layer, exposure) : OLX_ERROR_MEMORY;
  }
  return result == OLX_OK ? save_picture(b, view, "path", reference, layer, exposure) : result;
}

bool bench_open(bench *b, const bench_options *options, progress_line *line) {
  *b = (bench){.options = options, .progress = progress_of(line), .told = options->progress || line->shown};
  return bench_folder_make(&b->folder);
}

void bench_close(bench *b) {
  free_references(b);
  bench_folder_remove(&b->folder);
}

olx_result bench_run(bench *b, const experiment *e, cJSON *section) {
  const double start = clock_seconds(CLOCK_MONOTONIC), spent = clock_seconds(CLOCK_PROCESS_CPUTIME_ID);
  b->experiment = e;
  b->section = section;
  b->found = (findings){.table_count = 0};
  bench_tell(b, "begins");
  olx_result result = e->run(b);
  while (b->scene_count > 0) olx_scene_free(b->scenes[--b->scene_count].scene);
  b->found.seconds = clock_seconds(CLOCK_MONOTONIC) - start;
  b->found.processor_seconds = clock_seconds(CLOCK_PROCESS_CPUTIME_ID) - spent;
  if (result == OLX_OK && b->found.exhausted) result = OLX_ERROR_MEMORY;
  return result;
}
