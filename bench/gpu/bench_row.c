// Measures one row of the benchmark: draws and lights a scene frame after frame on a device, and times each part by the
// device's clock.
#include "bench_row.h"

#include "clock.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const bench_row ROWS[] = {
    {"cornell-2048", "Cornell box", "cornell", "cornell-2048", 2 * 2 * 2, 2048, 0.358, 0.000},
    {"cornell-256", "Cornell box, small maps", "cornell", "cornell-256", 2 * 2 * 2, 256, 0.302, 0.000},
    {"sponza", "Sponza", "sponza", "sponza", 8 * 2 * 4, 512, 0.332, 0.151},
    {"living-room", "living room", "living-room", "living-room", 4 * 4 * 4, 1024, 0.293, 4.401},
    {"kitchen", "kitchen", "kitchen", "kitchen", 4 * 4 * 4, 1024, 0.358, 9.334},
    {"pandora", "Pandora, all glossy, for San Miguel", "pandora-glossy", "pandora", 8 * 2 * 8, 1024, 0.520, 47.170},
};

const bench_row *bench_row_at(uint32_t index) { return index < sizeof ROWS / sizeof ROWS[0] ? &ROWS[index] : NULL; }

static const struct {
  const char *name;
  // Bytes per pixel: depth 4, normal 8, albedo 4, material 4, vertex normal 8, color 8, irradiance 8, glossy 8, display
  // 4; the denoiser's three passes also have the guide 16, light of a lobe 8, and its rows 8.
  uint32_t bytes;
} PARTS[BENCH_PARTS] = {
    [BENCH_SHADOW] = {"shadow", 0},
    [BENCH_GBUFFER] = {"gbuffer", 4 + 8 + 4 + 4 + 8 + 8},
    [BENCH_DIRECT] = {"direct", 4 + 8 + 4 + 4 + 8 + 8},
    [BENCH_IRRADIANCE] = {"irradiance", 4 + 8 + 4 + 8 + 8},
    [BENCH_GLOSSY] = {"glossy", 4 + 8 + 4 + 4 + 8 + 8},
    [BENCH_DENOISE] = {"denoise", (4 + 8 + 4 + 16 + 8 + 8 + 16 + 8) + (16 + 8 + 8) + (16 + 8 + 8 + 4 + 4 + 8 + 8)},
    [BENCH_COMPOSITE] = {"composite", 4 + 8 + 4 + 4 + 8 + 8 + 8 + 8},
    [BENCH_TONE] = {"tone", 8 + 4},
    [BENCH_FLOOR_DIFFUSE] = {"floor_irradiance", 4 + 8 + 8},
    [BENCH_FLOOR_GLOSSY] = {"floor_glossy", 4 + 8 + 4 + 4 + 8},
    [BENCH_DIFFUSE_RAYS] = {"diffuse_rays", 4 + 8 + 8 + 8},
    [BENCH_GLOSSY_RAYS] = {"glossy_rays", 4 + 8 + 4 + 4 + 8 + 8},
    [BENCH_DENOISE_BOTH] = {"denoise_both", (4 + 8 + 4 + 16 + 16 + 16 + 16 + 16) + 2 * (16 + 8 + 8) +
                                                (16 + 8 + 8 + 4 + 4 + 8 + 8) + (16 + 8 + 8 + 8)},
};

const char *bench_part_name(bench_part part) { return PARTS[part].name; }

uint32_t bench_part_bytes(bench_part part) { return PARTS[part].bytes; }

// The state of measuring a row; it points into itself.
typedef struct bench_job {
  gpu_device *device;
  const bench_settings *settings;
  bench_result *result;
  olx_scene_content *content;
  olx_field *field;
  olx_vulkan_field *uploaded;
  olx_vulkan_frame *frame;
  rasteriser raster;
  bench_probe probe;
  gpu_timer timer;
  raster_view view;
  olx_vulkan_settings lit;
  double *times; // per part and frame
} bench_job;

static bool fail_job(bench_job *job, const char *message) {
  snprintf(job->result->problem, sizeof job->result->problem, "%s", message);
  return false;
}

static bool fail_library(bench_job *job) { return fail_job(job, olx_last_error()); }

static bool fail_gpu(bench_job *job) { return fail_job(job, job->device->problem); }

static bool check_library(bench_job *job, olx_result result) { return result == OLX_OK || fail_library(job); }

static bool open_files(bench_job *job, const char *scene_path, const char *field_path) {
  const char *paths[2] = {scene_path, field_path};
  for (uint32_t i = 0; i < 2; i++) {
    if (access(paths[i], F_OK) == 0) continue;
    snprintf(job->result->problem, sizeof job->result->problem, "%s is not there", paths[i]);
    job->result->state = BENCH_SKIPPED;
    return false;
  }
  if (!check_library(job, olx_scene_content_load(scene_path, &job->content))) return false;
  if (!check_library(job, olx_field_open(field_path, &job->field))) return false;
  if (!check_library(job, olx_sample_settings_check(job->field, &job->settings->sample))) return false;
  const olx_field_info info = olx_field_describe(job->field);
  job->result->probes = info.probes.count;
  job->result->radiance_size = info.maps.size;
  job->result->triangles = job->content->triangle_count;
  double origin[3];
  olx_field_origin(job->field, origin);
  if (memcmp(origin, job->content->origin, sizeof origin) != 0) {
    return fail_job(job, "field and scene lie elsewhere: bake the field again");
  }
  job->result->other_scene = info.scene.hash != job->content->hash;
  const uint32_t compared = 1u << OLX_SELECT_CAGE | 1u << OLX_SELECT_BRICKS;
  if (!job->settings->compare || (info.select_mask & compared) == compared) return true;
  return fail_job(job, "to compare, a field needs cage and bricks (bake --select cage,bricks)");
}

static bool find_view(bench_job *job) {
  const olx_scene_content *c = job->content;
  const char *wanted = job->settings->camera;
  const float near = raster_view_near(c->bounds_min, c->bounds_max);
  for (uint32_t i = 0; i < c->camera_count; i++) {
    if (wanted && strcmp(c->cameras[i].name, wanted) != 0) continue;
    if (raster_view_make(&c->cameras[i], job->settings->width, job->settings->height, near, &job->view)) return true;
    return fail_job(job, "the camera's eye, target and angle define no view");
  }
  char message[128];
  snprintf(message, sizeof message, wanted ? "no camera named \"%.64s\"" : "the scene has no camera", wanted);
  return fail_job(job, message);
}

// The two methods that are compared.
static const struct {
  olx_tracer tracer;
  olx_select select;
} PAIR[BENCH_PAIR] = {{OLX_TRACER_TWO_LEVEL, OLX_SELECT_CAGE}, {OLX_TRACER_HIZ, OLX_SELECT_BRICKS}};

// Sets the tracers, selectors and light at hits that will be recorded.
static void name_ways(const bench_settings *s, olx_vulkan_targets *targets) {
  targets->tracers = 1u << s->sample.tracer;
  targets->selects = 1u << s->sample.select;
  targets->hits = 1u << s->sample.hits;
  for (uint32_t k = 0; s->compare && k < BENCH_PAIR; k++) {
    targets->tracers |= 1u << PAIR[k].tracer;
    targets->selects |= 1u << PAIR[k].select;
  }
}

static bool prepare(bench_job *job) {
  gpu_device *d = job->device;
  const bench_settings *s = job->settings;
  lamp_settings lamps = lamp_settings_default();
  if (s->quick) lamps = (lamp_settings){.map_size = 128, .sun_tiles = 1, .surface_samples = 1, .sky_samples = 2};
  if (!rasteriser_create(d, job->content, &lamps, s->width, s->height, &job->raster)) return fail_gpu(job);
  olx_vulkan_sizes sizes;
  if (!check_library(job, olx_vulkan_field_measure(&d->host, job->field, &sizes)) ||
      !check_library(job, olx_vulkan_field_create(&d->host, job->field, &job->uploaded)))
    return false;
  olx_vulkan_targets targets = frame_images_targets(&job->raster.images);
  targets.denoise = OLX_VULKAN_LOBE_GLOSSY;
  targets.passes = OLX_VULKAN_PASS_IRRADIANCE | OLX_VULKAN_PASS_GLOSSY | OLX_VULKAN_PASS_COMPOSITE;
  name_ways(s, &targets);
  if (!check_library(job, olx_vulkan_frame_create(job->uploaded, &targets, &job->frame))) return false;
  if (!bench_probe_create(d, job->uploaded, &job->raster, &job->probe) || !gpu_timer_create(d, &job->timer))
    return fail_gpu(job);
  job->result->field_bytes = sizes.device_bytes;
  job->result->scene_bytes = job->raster.scene.bytes;
  job->result->lamps = job->raster.shadows.lamp_count;
  job->result->shadow_maps = job->raster.shadows.view_count;
  job->lit = olx_vulkan_settings_default();
  job->lit.sample = s->sample;
  job->lit.denoise.filters.ray_spacing = s->ray_spacing;
  return true;
}

// ---- Frames

// Ends a part with a barrier, so that its time is separate.
static void end_part(const bench_job *job, bench_part part, gpu_timer *timer) {
  const gpu_device *d = job->device;
  const VkAccessFlags both = VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT;
  gpu_memory_barrier(d, d->commands, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_ACCESS_SHADER_WRITE_BIT,
                     VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, both);
  gpu_timer_mark(d, timer, d->commands, bench_part_name(part));
}

static void record_drawing(bench_job *job) {
  const gpu_device *d = job->device;
  const rasteriser *r = &job->raster;
  const draw_item item = draw_item_in_place(&r->scene);
  gpu_timer_begin(d, &job->timer, d->commands);
  shadow_pass_record(d, &r->shadows, d->commands, &item, 1);
  end_part(job, BENCH_SHADOW, &job->timer);
  gbuffer_pass_record(d, &r->gbuffer, d->commands, &r->images, &job->view, &item, 1);
  end_part(job, BENCH_GBUFFER, &job->timer);
  direct_pass_record(d, &r->direct, d->commands, &r->images, &job->view, DIRECT_LAMPS | DIRECT_SKY);
  end_part(job, BENCH_DIRECT, &job->timer);
}

static bool record_light(bench_job *job) {
  const gpu_device *d = job->device;
  const VkCommandBuffer commands = d->commands;
  if (!check_library(job, olx_vulkan_record_irradiance(job->frame, commands, &job->view.lit, &job->lit))) return false;
  end_part(job, BENCH_IRRADIANCE, &job->timer);
  if (!check_library(job, olx_vulkan_record_glossy(job->frame, commands, &job->view.lit, &job->lit))) return false;
  end_part(job, BENCH_GLOSSY, &job->timer);
  if (!check_library(job, olx_vulkan_record_denoise(job->frame, commands, &job->view.lit, &job->lit))) return false;
  end_part(job, BENCH_DENOISE, &job->timer);
  if (!check_library(job, olx_vulkan_record_composite(job->frame, commands, &job->view.lit, &job->lit,
                                                      OLX_VULKAN_ADD_DIFFUSE | OLX_VULKAN_ADD_GLOSSY)))
    return false;
  end_part(job, BENCH_COMPOSITE, &job->timer);
  tone_pass_record(d, &job->raster.tone, commands, &job->raster.images, 1.0f);
  end_part(job, BENCH_TONE, &job->timer);
  for (uint32_t glossy = 0; glossy < 2; glossy++) {
    bench_probe_floor(d, &job->probe, job->uploaded, &job->raster, &job->view, glossy, commands);
    end_part(job, glossy ? BENCH_FLOOR_GLOSSY : BENCH_FLOOR_DIFFUSE, &job->timer);
  }
  return true;
}

// Advances the index of the next denoised frame of those lobes; each method starts at 0.
static void number_frame(bench_job *job, uint32_t lobes) {
  olx_vulkan_denoise *denoise = &job->lit.denoise;
  denoise->frame = denoise->lobes == lobes ? denoise->frame + 1 : 0;
  denoise->lobes = lobes;
  denoise->previous = job->view.lit;
  job->lit.sample_index = denoise->frame;
}

static bool run_frame(bench_job *job, double milliseconds[GPU_TIMER_MARKS]) {
  const char *names[GPU_TIMER_MARKS];
  number_frame(job, OLX_VULKAN_LOBE_GLOSSY);
  if (!gpu_commands_begin(job->device)) return fail_gpu(job);
  record_drawing(job);
  if (!record_light(job)) return false;
  if (!gpu_commands_run(job->device)) return fail_gpu(job);
  return gpu_timer_read(job->device, &job->timer, milliseconds, names) == BENCH_FRAME_PARTS ||
         fail_job(job, "the timestamps of a frame could not be read");
}

static int by_value(const void *a, const void *b) {
  const double x = *(const double *)a, y = *(const double *)b;
  return x < y ? -1 : x > y;
}

static double median(double *values, uint32_t count) {
  qsort(values, count, sizeof *values, by_value);
  return 0.5 * (values[(count - 1) / 2] + values[count / 2]);
}

// Runs a frame of the paper's denoised method, on the G-buffer of the last frame.
static bool run_denoised_frame(bench_job *job, double milliseconds[GPU_TIMER_MARKS]) {
  const gpu_device *d = job->device;
  const char *names[GPU_TIMER_MARKS];
  number_frame(job, OLX_VULKAN_LOBE_DIFFUSE | OLX_VULKAN_LOBE_GLOSSY);
  if (!gpu_commands_begin(job->device)) return fail_gpu(job);
  gpu_timer_begin(d, &job->timer, d->commands);
  if (!check_library(job, olx_vulkan_record_diffuse(job->frame, d->commands, &job->view.lit, &job->lit))) return false;
  end_part(job, BENCH_DIFFUSE_RAYS, &job->timer);
  if (!check_library(job, olx_vulkan_record_glossy(job->frame, d->commands, &job->view.lit, &job->lit))) return false;
  end_part(job, BENCH_GLOSSY_RAYS, &job->timer);
  if (!check_library(job, olx_vulkan_record_denoise(job->frame, d->commands, &job->view.lit, &job->lit))) return false;
  end_part(job, BENCH_DENOISE_BOTH, &job->timer);
  if (!gpu_commands_run(job->device)) return fail_gpu(job);
  return gpu_timer_read(job->device, &job->timer, milliseconds, names) == BENCH_PARTS - BENCH_FRAME_PARTS ||
         fail_job(job, "the timestamps of a frame could not be read");
}

typedef bool run_frame_function(bench_job *job, double milliseconds[GPU_TIMER_MARKS]);

// Runs frames that are not counted, because clocks rise under load: for half a second, and at least two.
static bool warm_up(bench_job *job, run_frame_function *run) {
  double milliseconds[GPU_TIMER_MARKS];
  const double start = clock_seconds(CLOCK_MONOTONIC);
  const bool quick = job->settings->quick;
  for (uint32_t i = 0; i < (quick ? 1u : 2u) || (!quick && clock_seconds(CLOCK_MONOTONIC) - start < 0.5); i++) {
    if (!run(job, milliseconds)) return false;
  }
  return true;
}

// Runs frames whose parts begin with `first`.
static bool run_frames(bench_job *job, run_frame_function *run, uint32_t first, uint32_t parts) {
  const uint32_t frames = job->settings->frames;
  double milliseconds[GPU_TIMER_MARKS];
  if (!warm_up(job, run)) return false;
  for (uint32_t f = 0; f < frames; f++) {
    if (!run(job, milliseconds)) return false;
    for (uint32_t p = 0; p < parts; p++) job->times[(size_t)p * frames + f] = milliseconds[p];
  }
  for (uint32_t p = 0; p < parts; p++) {
    job->result->milliseconds[first + p] = median(job->times + (size_t)p * frames, frames);
    job->result->least[first + p] = job->times[(size_t)p * frames]; // sorted by the median
  }
  return true;
}

static bool run_all_frames(bench_job *job) {
  if (!run_frames(job, run_frame, 0, BENCH_FRAME_PARTS)) return false;
  olx_vulkan_targets targets = frame_images_targets(&job->raster.images);
  targets.denoise = OLX_VULKAN_LOBE_DIFFUSE | OLX_VULKAN_LOBE_GLOSSY;
  targets.passes = OLX_VULKAN_PASS_DIFFUSE | OLX_VULKAN_PASS_GLOSSY;
  name_ways(job->settings, &targets);
  return check_library(job, olx_vulkan_frame_resize(job->frame, &targets)) &&
         run_frames(job, run_denoised_frame, BENCH_FRAME_PARTS, BENCH_PARTS - BENCH_FRAME_PARTS);
}

// ---- The comparison

static bool run_glossy(bench_job *job, uint32_t index, double *milliseconds) {
  const gpu_device *d = job->device;
  double parts[GPU_TIMER_MARKS];
  const char *names[GPU_TIMER_MARKS];
  job->lit.sample_index = index;
  if (!gpu_commands_begin(job->device)) return fail_gpu(job);
  gpu_timer_begin(d, &job->timer, d->commands);
  if (!check_library(job, olx_vulkan_record_glossy(job->frame, d->commands, &job->view.lit, &job->lit))) return false;
  end_part(job, BENCH_GLOSSY, &job->timer);
  if (!gpu_commands_run(job->device)) return fail_gpu(job);
  if (gpu_timer_read(job->device, &job->timer, parts, names) != 1) return fail_job(job, "no timestamp");
  *milliseconds = parts[0];
  return true;
}

// Runs frames of the two methods in turns, on the G-buffer of the last frame.
static bool run_pair(bench_job *job) {
  job->lit.denoise.lobes = 0;
  const uint32_t frames = job->settings->frames;
  for (uint32_t f = 0; f < frames + 1; f++) {
    for (uint32_t k = 0; k < BENCH_PAIR; k++) {
      job->lit.sample.tracer = PAIR[k].tracer;
      job->lit.sample.select = PAIR[k].select;
      double milliseconds = 0;
      if (!run_glossy(job, f, &milliseconds)) return false;
      if (f > 0) job->times[k * frames + f - 1] = milliseconds; // the first frame is a warm-up
    }
  }
  for (uint32_t k = 0; k < BENCH_PAIR; k++) {
    job->result->pair_milliseconds[k] = median(job->times + k * frames, frames);
    if (!bench_probe_count(job->device, &job->probe, job->uploaded, &job->raster, &job->view, PAIR[k].tracer,
                           PAIR[k].select, 2, &job->result->pair_counts[k]))
      return fail_gpu(job);
  }
  return true;
}

// Compares the methods on surfaces that are drawn once.
static bool compare_ways(bench_job *job) {
  double milliseconds[GPU_TIMER_MARKS];
  return run_frame(job, milliseconds) && run_pair(job);
}

static bool run_job(bench_job *job, const char *scene_path, const char *field_path) {
  if (!open_files(job, scene_path, field_path) || !find_view(job) || !prepare(job)) return false;
  job->times = calloc((size_t)job->settings->frames * BENCH_PARTS, sizeof *job->times);
  if (!job->times) return fail_job(job, "out of memory");
  if (job->settings->compare) return compare_ways(job);
  const olx_sample_settings *sample = &job->settings->sample;
  return run_all_frames(job) && (bench_probe_count(job->device, &job->probe, job->uploaded, &job->raster, &job->view,
                                                   sample->tracer, sample->select, 2, &job->result->counts) ||
                                 fail_gpu(job));
}

void bench_run(gpu_device *device, const char *scene_path, const char *field_path, const bench_settings *settings,
               bench_result *result) {
  bench_job *job = calloc(1, sizeof *job);
  *result = (bench_result){.state = BENCH_FAILED, .problem = "out of memory"};
  if (!job) return;
  job->device = device;
  job->settings = settings;
  job->result = result;
  if (run_job(job, scene_path, field_path)) *result->problem = 0, result->state = BENCH_DONE;
  gpu_timer_destroy(device, &job->timer);
  bench_probe_destroy(device, &job->probe);
  olx_vulkan_frame_destroy(job->frame);
  olx_vulkan_field_destroy(job->uploaded);
  rasteriser_destroy(device, &job->raster);
  olx_field_close(job->field);
  olx_scene_content_free(job->content);
  free(job->times);
  free(job);
}
