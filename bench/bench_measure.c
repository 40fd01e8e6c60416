// Bakes fields for experiments, renders images in independent halves, and estimates errors from which noise is removed.
#include "bench_measure.h"

#include "clock.h"
#include "stop.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum {
  ROUGH_SAMPLES = 600,
  ROUGH_VOXELS = 80,
  FREE_SELECTORS = 1 << OLX_SELECT_VORONOI | 1 << OLX_SELECT_OCTREE | 1 << OLX_SELECT_BRICKS // of placed probes
};

bool bench_folder_make(bench_folder *folder) {
  const char *parent = getenv("TMPDIR");
  const int length =
      snprintf(folder->path, sizeof folder->path, "%s/octalux-bench-XXXXXX", parent && *parent ? parent : "/tmp");
  if (length <= 0 || (size_t)length >= sizeof folder->path || !mkdtemp(folder->path)) return false;
  stop_remove_folder(folder->path);
  return true;
}

void bench_folder_remove(const bench_folder *folder) {
  rmdir(folder->path);
  stop_remove_folder(NULL);
}

bench_name bench_probes_name(const bench_probes *probes) {
  const uint32_t *grid = probes->exact ? probes->exact->count : probes->grid;
  bench_name name;
  int used = 0;
  if (probes->file) {
    const char *slash = strrchr(probes->file, '/');
    used = snprintf(name.text, sizeof name.text, "%.48s", slash ? slash + 1 : probes->file);
  } else if (grid[0]) {
    used = snprintf(name.text, sizeof name.text, "%ux%ux%u grid", grid[0], grid[1], grid[2]);
  } else {
    const bool moved = probes->optimize != OLX_OPTIMIZE_NONE;
    if (probes->count) used = snprintf(name.text, sizeof name.text, "%u ", probes->count);
    used += snprintf(name.text + used, sizeof name.text - (size_t)used, "%s%s%s", olx_place_method_name(probes->method),
                     moved ? " + " : "", moved ? olx_place_optimizer_name(probes->optimize) : "");
  }
  if (probes->texels != 512) snprintf(name.text + used, sizeof name.text - (size_t)used, ", %u^2", probes->texels);
  return name;
}

static olx_result place(const olx_scene *scene, const bench_probes *probes, const bench_bake *bake,
                        const olx_progress *progress, olx_probe_set *set) {
  if (probes->file) return olx_probe_set_load(probes->file, olx_scene_describe(scene).origin, set);
  olx_place_settings settings = olx_place_settings_default(scene);
  settings.method = probes->method;
  settings.count = probes->count;
  settings.optimize = probes->optimize;
  settings.resolution = probes->texels;
  settings.threads = bake->threads;
  if (bake->rough) {
    settings.candidates = settings.surfels = ROUGH_SAMPLES;
    settings.voxels = ROUGH_VOXELS;
  }
  return olx_place(scene, &settings, progress, set);
}

// Finds the positions of probes; the caller releases them.
static olx_result find_positions(const olx_scene *scene, const bench_probes *probes, const bench_bake *bake,
                                 const olx_progress *progress, olx_vec3 **positions, bench_field *made) {
  olx_probe_set set;
  const double start = clock_seconds(CLOCK_PROCESS_CPUTIME_ID);
  const olx_result result = place(scene, probes, bake, progress, &set);
  if (result != OLX_OK) return result;
  made->place_seconds = clock_seconds(CLOCK_PROCESS_CPUTIME_ID) - start;
  made->coverage = set.report.coverage;
  made->info.probes.count = set.count;
  *positions = malloc(set.count * sizeof **positions);
  for (uint32_t i = 0; *positions && i < set.count; ++i) (*positions)[i] = set.probes[i].position;
  olx_probe_set_free(&set);
  return *positions ? OLX_OK : OLX_ERROR_MEMORY;
}

olx_result bench_field_make(const olx_scene *scene, const bench_probes *probes, const bench_bake *bake,
                            const bench_folder *folder, uint32_t number, const olx_progress *progress,
                            bench_field *made) {
  *made = (bench_field){.field = NULL};
  snprintf(made->path, sizeof made->path, "%s/%u.olx", folder->path, number);
  olx_bake_settings settings = olx_bake_settings_default(scene);
  settings.probe_light = !bake->no_probe_light;
  settings.irradiance_grid = bake->irradiance_grid;
  settings.irradiance_size = bake->irradiance_size;
  settings.light_samples = bake->light_samples;
  settings.irradiance_form = bake->form;
  settings.bounces = bake->bounces;
  settings.bounce_gather = bake->gather;
  settings.classic = bake->classic_size > 0;
  if (settings.classic) settings.classic_size = bake->classic_size;
  if (settings.classic) settings.classic_cube_size = 2 * bake->classic_size;
  settings.radiance_size = probes->texels;
  settings.threads = bake->threads;
  settings.seed = bake->seed;
  settings.raster = bake->raster;
  if (bake->noise > 0.0f) settings.noise = bake->noise;
  settings.select_mask = bake->plain ? 0 : probes->grid[0] ? 1u << OLX_SELECT_CAGE : FREE_SELECTORS;
  olx_vec3 *positions = NULL;
  olx_result result;
  if (probes->exact) {
    settings.grid = *probes->exact;
    result = OLX_OK;
  } else if (probes->grid[0]) {
    result = olx_scene_probe_grid(scene, probes->grid, &settings.grid);
  } else {
    result = find_positions(scene, probes, bake, progress, &positions, made);
    settings.probes = positions;
    settings.probe_count = made->info.probes.count;
  }
  const double start = clock_seconds(CLOCK_PROCESS_CPUTIME_ID);
  olx_bake_stats stats = {.seconds = 0.0};
  if (result == OLX_OK) result = olx_bake(scene, &settings, made->path, progress, &stats);
  made->bake_seconds = clock_seconds(CLOCK_PROCESS_CPUTIME_ID) - start;
  if (stats.seconds > 0.0) {
    const double share = made->bake_seconds / stats.seconds;
    made->classic_seconds = share * stats.classic_seconds;
    made->capture_seconds = share * stats.capture_seconds;
    made->raster_seconds = share * stats.raster_seconds;
  }
  free(positions);
  if (result == OLX_OK) result = olx_field_open(made->path, &made->field);
  if (result == OLX_OK) made->info = olx_field_describe(made->field);
  return result;
}

uint64_t bench_geometry_bytes(const olx_field_info *info) {
  return info->bytes.geometry + info->bytes.normal + info->bytes.distance + info->bytes.pyramid;
}

uint64_t bench_light_bytes(const olx_field_info *info) {
  return info->bytes.material + info->bytes.direct + info->bytes.indirect + info->bytes.emission + info->bytes.radiance;
}

double bench_texel_bytes(const olx_field_info *info) {
  const double texels = (double)info->probes.count * info->maps.size * info->maps.size;
  return (double)(bench_geometry_bytes(info) + bench_light_bytes(info)) / texels;
}

void bench_field_close(bench_field *made) {
  olx_field_close(made->field);
  made->field = NULL;
  if (made->path[0]) unlink(made->path);
}

static void add_stats(olx_render_stats *sum, const olx_render_stats *one) {
  sum->seconds += one->seconds;
  sum->direct_seconds += one->direct_seconds;
  sum->diffuse_seconds += one->diffuse_seconds;
  sum->denoise_seconds += one->denoise_seconds;
  sum->glossy_seconds += one->glossy_seconds;
  sum->field_rays += one->field_rays;
  sum->field_unresolved += one->field_unresolved;
  sum->field_steps += one->field_steps;
  sum->field_probes += one->field_probes;
}

uint32_t bench_scene_cameras(const olx_scene *scene, olx_camera cameras[BENCH_CAMERAS]) {
  const uint32_t all = olx_scene_describe(scene).cameras, count = all < BENCH_CAMERAS ? all : BENCH_CAMERAS;
  for (uint32_t c = 0; c < count; ++c) cameras[c] = olx_scene_camera(scene, c);
  return count;
}

static olx_result render_way(const olx_scene *scene, const olx_camera *camera, const bench_way *way, uint32_t seed,
                             const olx_progress *progress, olx_image *image, olx_render_stats *stats) {
  olx_render_settings settings = way->settings;
  settings.seed = seed;
  if (way->frames == 0) return olx_render(scene, way->field, camera, &settings, progress, image, stats);
  olx_camera *cameras = malloc(way->frames * sizeof *cameras);
  if (!cameras) return OLX_ERROR_MEMORY;
  for (uint32_t i = 0; i < way->frames; ++i) cameras[i] = *camera;
  const olx_result result =
      olx_render_frames(scene, way->field, cameras, way->frames, &settings, progress, image, stats);
  free(cameras);
  return result;
}

olx_result bench_images_render(const olx_scene *scene, const olx_camera *cameras, uint32_t count, const bench_way *way,
                               uint32_t stream, const olx_progress *progress, bench_images *images) {
  *images = (bench_images){.cameras = count, .frames = way->frames > 0};
  for (uint32_t c = 0; c < count; ++c) {
    images->camera[c] = cameras[c];
    for (uint32_t h = 0; h < 2; ++h) {
      olx_render_stats stats;
      const olx_result result =
          render_way(scene, &cameras[c], way, 2 * stream + h + 1, progress, &images->half[c][h], &stats);
      if (result != OLX_OK) return result;
      add_stats(&images->stats, &stats);
    }
  }
  return OLX_OK;
}

void bench_images_free(bench_images *images) {
  for (uint32_t c = 0; c < images->cameras; ++c) {
    for (uint32_t h = 0; h < 2; ++h) olx_image_free(&images->half[c][h]);
    olx_image_free(&images->mean[c]);
  }
  *images = (bench_images){.cameras = 0};
}

static olx_vec3 halfway(olx_vec3 a, olx_vec3 b) {
  return (olx_vec3){0.5f * (a.x + b.x), 0.5f * (a.y + b.y), 0.5f * (a.z + b.z)};
}

const olx_image *bench_images_mean(bench_images *images, uint32_t camera) {
  olx_image *mean = &images->mean[camera];
  if (images->frames) return &images->half[camera][0];
  if (mean->width) return mean;
  const olx_image *half = images->half[camera];
  const uint32_t light = (1u << (OLX_LAYER_INDIRECT_GLOSSY + 1)) - 1;
  if (olx_image_create(half->width, half->height, light, mean) != OLX_OK) return NULL;
  const size_t pixels = (size_t)half->width * half->height;
  for (uint32_t layer = 0; layer <= OLX_LAYER_INDIRECT_GLOSSY; ++layer) {
    const olx_vec3 *a = half[0].layers[layer], *b = half[1].layers[layer];
    for (size_t i = 0; i < pixels; ++i) mean->layers[layer][i] = halfway(a[i], b[i]);
  }
  return mean;
}

typedef struct error_sum {
  double square, spread, power, image, reference;
  double values;
} error_sum;

static olx_vec3 light_of(const olx_image *image, size_t pixel, bench_light light) {
  if (light == BENCH_BEAUTY) return image->layers[OLX_LAYER_BEAUTY][pixel];
  const olx_vec3 glossy = image->layers[OLX_LAYER_INDIRECT_GLOSSY][pixel];
  if (light == BENCH_GLOSSY) return glossy;
  const olx_vec3 diffuse = image->layers[OLX_LAYER_INDIRECT_DIFFUSE][pixel];
  if (light == BENCH_DIFFUSE) return diffuse;
  return (olx_vec3){glossy.x + diffuse.x, glossy.y + diffuse.y, glossy.z + diffuse.z};
}

// Adds the squared error of one pixel, over its channels.
static double add_pixel(error_sum *sum, const float *a0, const float *a1, const float *b0, const float *b1,
                        bool frames) {
  double square = 0.0;
  for (int c = 0; c < 3; ++c) {
    const double x0 = (double)a0[c], x1 = (double)a1[c], y0 = (double)b0[c], y1 = (double)b1[c];
    square += frames ? 0.5 * ((x0 - y0) * (x0 - y1) + (x1 - y0) * (x1 - y1))
                     : 0.5 * ((x0 - y0) * (x1 - y1) + (x0 - y1) * (x1 - y0));
    sum->power += y0 * y1;
    sum->image += 0.5 * (x0 + x1);
    sum->reference += 0.5 * (y0 + y1);
  }
  sum->square += square;
  sum->values += 3.0;
  return square;
}

// The difference of two neighbouring pixels estimates the noise of both. It is an upper bound, because their errors
// differ as well.
static void add_image(error_sum *sum, const olx_image a[2], const olx_image b[2], bench_light light, bool frames) {
  const size_t pixels = (size_t)a->width * a->height;
  double before = 0.0;
  for (size_t i = 0; i < pixels; ++i) {
    const olx_vec3 values[4] = {light_of(&a[0], i, light), light_of(&a[1], i, light), light_of(&b[0], i, light),
                                light_of(&b[1], i, light)};
    const double square = add_pixel(sum, &values[0].x, &values[1].x, &values[2].x, &values[3].x, frames);
    if (i % 2) sum->spread += (square - before) * (square - before);
    before = square;
  }
}

bench_error bench_error_of(const bench_images *images, const bench_images *references, bench_light light,
                           uint32_t camera) {
  error_sum sum = {0};
  for (uint32_t c = 0; c < images->cameras; ++c) {
    if (camera == BENCH_CAMERAS || c == camera)
      add_image(&sum, images->half[c], references->half[c], light, images->frames);
  }
  return (bench_error){.mse = sum.square / sum.values,
                       .noise = sqrt(sum.spread) / sum.values,
                       .relative_mse = sum.square / sum.power,
                       .bias = (sum.image - sum.reference) / sum.reference,
                       .mean = sum.image / sum.values,
                       .reference_mean = sum.reference / sum.values};
}

static int ascending(const void *a, const void *b) {
  const double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

double bench_median(double *values, uint32_t count) {
  qsort(values, count, sizeof *values, ascending);
  return count % 2 ? values[count / 2] : 0.5 * (values[count / 2 - 1] + values[count / 2]);
}
