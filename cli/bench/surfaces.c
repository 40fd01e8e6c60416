// Light stored at surfaces, with default settings throughout: errors of both indirect layers for placed probes and for the
// scene's grid, how far two bakes differ, and light behind walls and through gaps.
#include "experiment_list.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { BLOCK = 8, QUICK_TEXELS = 64, TEXELS = 512, QUICK_SCENES = 2 };

// Blocks of pixels darker than this share of the picture's mean do not count: noise rules there.
static const double DARK = 0.01;

// The first are those of --quick.
static const char *const scenes[] = {"builtin:cornell", "builtin:labyrinth", "builtin:cornell-glossy", "builtin:pillars",
                                     "living-room",     "sponza",            "kitchen",                "white-room",
                                     "small-house",     "godot-rooms",       "veach-ajar"};

static const bench_column light_columns[] = {
    {"scene", "scene", BENCH_NAME, NULL, NULL},
    {"probes", "probes", BENCH_NAME, NULL, "where they stand"},
    {"camera", "camera", BENCH_NAME, NULL, NULL},
    {"diffuse_relative_mse", "diffuse: relative MSE", BENCH_QUALITY, NULL, "of indirect diffuse light"},
    {"diffuse_bias", "bias", BENCH_QUALITY, "%", "of indirect diffuse light"},
    {"bright", "brightest block", BENCH_QUALITY, NULL, "light over the reference's in 8 x 8 pixels, at most"},
    {"dark", "darkest block", BENCH_QUALITY, NULL, "light over the reference's in 8 x 8 pixels, at least"},
    {"glossy_relative_mse", "glossy: relative MSE", BENCH_QUALITY, NULL, "of indirect glossy light"},
    {"glossy_bias", "bias", BENCH_QUALITY, "%", "of indirect glossy light"},
};

static const bench_column field_columns[] = {
    {"scene", "scene", BENCH_NAME, NULL, NULL},
    {"probes", "probes", BENCH_NAME, NULL, "where they stand"},
    {"count", "count", BENCH_COUNT, NULL, "light field probes"},
    {"mib", "field", BENCH_COUNT, "MiB", "the file"},
    {"stored", "stored", BENCH_QUALITY, "%", "points of surfaces whose light is stored"},
    {"stored_relative_mse", "relative MSE", BENCH_QUALITY, NULL, "of irradiance at those points"},
    {"fallen_back_relative_mse", "else", BENCH_QUALITY, NULL, "relative MSE where the irradiance volume answers instead"},
    {"space_relative_mse", "in space", BENCH_QUALITY, NULL, "relative MSE of the irradiance volume in free space"},
    {"probes_relative_mse", "by probes", BENCH_QUALITY, NULL, "relative MSE of irradiance probes in free space"},
    {"bakes_rms", "two bakes", BENCH_QUALITY, "%", "RMS difference of indirect diffuse light, over its mean, all cameras"},
    {"diffuse_ns", "diffuse pass", BENCH_TIME, "ns", "processor time a sample"},
    {"glossy_us", "glossy ray", BENCH_TIME, "\u00b5s", "processor time"},
    {"place_s", "place", BENCH_TIME, "s", "processor time"},
    {"bake_s", "bake", BENCH_TIME, "s", "processor time"},
};

static const bench_column leak_columns[] = {
    {"wall", "wall", BENCH_NAME, NULL, "between a lit and a dark room"},
    {"probes", "probes", BENCH_NAME, NULL, "where they stand"},
    {"dark", "dark room", BENCH_QUALITY, NULL, "mean of indirect diffuse light over the lit room's, path traced"},
    {"leak", "leak", BENCH_QUALITY, NULL, "what the field has too much of it, over the lit room's"},
    {"bias", "bias", BENCH_QUALITY, "%", "what the field has too much of it, over the dark room's"},
};

static const bench_plot light_plots[] = {{"Error of indirect diffuse light", NULL, "diffuse_relative_mse", NULL, false, true}};
static const bench_plot field_plots[] = {{"Two bakes of a scene", NULL, "bakes_rms", NULL, false, false}};
static const bench_plot leak_plots[] = {{"Light behind walls", NULL, "leak", NULL, false, false}};

typedef struct surface_run {
  bench *b;
  const char *name;
  olx_scene *scene;
  bool placed;
  olx_grid grid; // where probes are not placed
  olx_camera cameras[BENCH_CAMERAS];
  uint32_t camera_count;
  bench_images *reference;
  bench_table *light, *fields, *leaks;
} surface_run;

// Placed probes, and the grid unless a quick look is enough.
static uint32_t way_count(const surface_run *r) { return r->b->options->quick ? 1 : 2; }

// As many as a bake makes when nothing else is said, or one in a quick look.
static uint32_t bounces(const surface_run *r) {
  return r->b->options->quick ? bench_bounces(r->b) : olx_bake_settings_default(r->scene).bounces;
}

static const char *where(const surface_run *r) { return r->placed ? "placed" : "grid"; }

// As `place` and `bake` do it when nothing else is said, but for probe light, which an audit judges.
static olx_result bake(const surface_run *r, uint32_t seed, bool probe_light, bench_field *made) {
  const olx_bake_settings defaults = olx_bake_settings_default(r->scene);
  const bool quick = r->b->options->quick;
  const bench_probes probes = {.method = OLX_PLACE_COVER,
                               .exact = r->placed ? NULL : &r->grid,
                               .texels = quick ? QUICK_TEXELS : TEXELS};
  const bench_bake wanted = {.irradiance_grid = defaults.irradiance_grid,
                             .irradiance_size = quick ? 16 : defaults.irradiance_size,
                             .light_samples = defaults.light_samples,
                             .bounces = bounces(r),
                             .plain = true,
                             .no_probe_light = !probe_light,
                             .seed = seed};
  return bench_bake_field(r->b, r->scene, &probes, &wanted, made);
}

static olx_result render(const surface_run *r, const olx_field *field, bench_images *images) {
  bench_way way = {.name = where(r), .field = field, .settings = bench_field_settings(r->b)};
  way.settings.diffuse = OLX_DIFFUSE_SURFACE;
  return bench_pictures(r->b, r->scene, r->cameras, r->camera_count, &way, images);
}

static double light_of(const olx_image *image, uint32_t x, uint32_t y) {
  const olx_vec3 light = image->layers[OLX_LAYER_INDIRECT_DIFFUSE][(size_t)y * image->width + x];
  return (double)light.x + (double)light.y + (double)light.z;
}

static double block_light(const olx_image *image, uint32_t left, uint32_t top) {
  double sum = 0.0;
  for (uint32_t i = 0; i < BLOCK * BLOCK; ++i) sum += light_of(image, left + i % BLOCK, top + i / BLOCK);
  return sum / (BLOCK * BLOCK);
}

static double mean_light(const olx_image *image) {
  double sum = 0.0;
  for (uint32_t y = 0; y < image->height; ++y) {
    for (uint32_t x = 0; x < image->width; ++x) sum += light_of(image, x, y);
  }
  return sum / ((double)image->width * image->height);
}

// The least and the greatest ratio of light among blocks of pixels that are not dark in the reference.
static void compare_blocks(const olx_image *image, const olx_image *reference, double *least, double *most) {
  const double dark = DARK * mean_light(reference);
  *least = *most = 1.0;
  for (uint32_t top = 0; top + BLOCK <= image->height; top += BLOCK) {
    for (uint32_t left = 0; left + BLOCK <= image->width; left += BLOCK) {
      const double truth = block_light(reference, left, top);
      if (truth <= dark) continue;
      const double ratio = block_light(image, left, top) / truth;
      *least = fmin(*least, ratio);
      *most = fmax(*most, ratio);
    }
  }
}

static olx_result add_pictures(const surface_run *r, bench_images *images) {
  for (uint32_t c = 0; c < r->camera_count; ++c) {
    const olx_image *image = bench_images_mean(images, c), *reference = bench_images_mean(r->reference, c);
    if (!image || !reference) return OLX_ERROR_MEMORY;
    const bench_error diffuse = bench_error_of(images, r->reference, BENCH_DIFFUSE, c),
                      glossy = bench_error_of(images, r->reference, BENCH_GLOSSY, c);
    const bool reflects = glossy.reference_mean > 0.0;
    double dark, bright;
    compare_blocks(image, reference, &dark, &bright);
    FINDINGS_ROW(&r->b->found, r->light, TEXT_CELL(bench_scene_title(r->name)), TEXT_CELL(where(r)),
                 TEXT_CELL(r->cameras[c].name), NUMBER_CELL(diffuse.relative_mse), NUMBER_CELL(diffuse.bias),
                 NUMBER_CELL(bright), NUMBER_CELL(dark), NUMBER_CELL(reflects ? glossy.relative_mse : NAN),
                 NUMBER_CELL(reflects ? glossy.bias : NAN));
    char view[128];
    snprintf(view, sizeof view, "%s, %s: %s", bench_scene_title(r->name), r->cameras[c].name, where(r));
    const bench_shown shown = {.way = where(r), .images = images, .camera = c};
    const olx_result result = bench_show(r->b, view, OLX_LAYER_INDIRECT_DIFFUSE, &shown, 1, r->reference, c);
    if (result != OLX_OK) return result;
  }
  return OLX_OK;
}

// RMS difference of the pictures of two fields, over the mean. What is told of the other one stays in *other.
static olx_result compare_bakes(const surface_run *r, bench_images *images, bench_field *other, double *rms) {
  bench_images again = {0};
  double squares = 0.0, sum = 0.0, pixels = 0.0;
  olx_result result = bake(r, 1, false, other);
  if (result == OLX_OK) result = render(r, other->field, &again);
  for (uint32_t c = 0; c < r->camera_count && result == OLX_OK; ++c) {
    const olx_image *a = bench_images_mean(images, c), *b = bench_images_mean(&again, c);
    if (!a || !b) {
      result = OLX_ERROR_MEMORY;
      break;
    }
    for (uint32_t i = 0; i < a->width * a->height; ++i) {
      const double one = light_of(a, i % a->width, i / a->width), two = light_of(b, i % a->width, i / a->width);
      squares += (one - two) * (one - two);
      sum += one;
      pixels += 1.0;
    }
  }
  *rms = sum > 0.0 ? sqrt(squares * pixels) / sum : NAN;
  bench_images_free(&again);
  bench_field_close(other);
  return result;
}

static double error_or_none(const olx_audit_points *points) { return points->count ? points->relative_mse : NAN; }

static olx_result add_field(const surface_run *r, const bench_field *made, bench_images *images) {
  const bool quick = r->b->options->quick;
  olx_audit_settings settings = olx_audit_settings_default();
  settings.threads = r->b->options->threads;
  settings.rays = 1000;
  settings.points = quick ? 100 : 2000;
  settings.space_points = quick ? 50 : 2000;
  settings.spp = quick ? 64 : 1024;
  olx_audit audit;
  bench_field plain; // of the size and the time that bakes take when nothing else is said
  double rms;
  bench_tell(r->b, "audit of %s", r->name);
  olx_result result = olx_audit_field(r->scene, made->field, &settings, &r->b->progress, &audit);
  if (result == OLX_OK) result = compare_bakes(r, images, &plain, &rms);
  if (result != OLX_OK) return result;
  const olx_render_stats *stats = &images->stats;
  const olx_image *image = &images->half[0][0];
  const double samples = 2.0 * r->camera_count * image->width * image->height * bench_spp(r->b);
  FINDINGS_ROW(&r->b->found, r->fields, TEXT_CELL(bench_scene_title(r->name)), TEXT_CELL(where(r)),
               NUMBER_CELL(made->info.probe_count), NUMBER_CELL((double)plain.info.file_bytes / 1048576.0),
               NUMBER_CELL((double)audit.stored.count / (double)audit.points.count),
               NUMBER_CELL(error_or_none(&audit.stored)), NUMBER_CELL(error_or_none(&audit.fallen_back)),
               NUMBER_CELL(error_or_none(&audit.space_volume)), NUMBER_CELL(error_or_none(&audit.space_probes)),
               NUMBER_CELL(rms), NUMBER_CELL(1e9 * stats->diffuse_seconds / samples),
               NUMBER_CELL(stats->field_rays ? 1e6 * stats->glossy_seconds / (double)stats->field_rays : NAN),
               NUMBER_CELL(r->placed ? plain.place_seconds : NAN), NUMBER_CELL(plain.bake_seconds));
  return OLX_OK;
}

static olx_result run_way(surface_run *r) {
  bench_field made;
  bench_images images = {0};
  olx_result result = bake(r, 0, true, &made);
  if (result == OLX_OK) result = render(r, made.field, &images);
  if (result == OLX_OK) result = add_pictures(r, &images);
  if (result == OLX_OK) result = add_field(r, &made, &images);
  bench_images_free(&images);
  bench_field_close(&made);
  return result;
}

// The scene and its cameras. r->scene is NULL when it is not to be had.
static olx_result open_scene(surface_run *r) {
  r->scene = NULL;
  if (bench_leaves_out(r->b, r->name)) return OLX_OK;
  const olx_result result = bench_scene(r->b, r->name, &r->scene);
  if (result != OLX_OK || !r->scene) return result;
  r->camera_count = bench_scene_cameras(r->scene, r->cameras);
  r->grid = olx_bake_settings_default(r->scene).grid;
  return OLX_OK;
}

static olx_result run_scene(surface_run *r) {
  olx_result result = open_scene(r);
  if (result != OLX_OK || !r->scene || r->camera_count == 0) return result;
  const olx_render_settings settings = bench_path_settings(r->b);
  result = bench_reference(r->b, r->scene, r->cameras, r->camera_count, &settings, bounces(r) + 1, &r->reference);
  for (uint32_t way = 0; way < way_count(r) && result == OLX_OK; ++way) {
    r->placed = way == 0;
    result = run_way(r);
  }
  return result;
}

static double camera_light(bench_images *images, uint32_t camera) {
  const olx_image *image = bench_images_mean(images, camera);
  return image ? mean_light(image) : NAN;
}

static olx_result run_leak(surface_run *r, const char *wall) {
  olx_result result = open_scene(r);
  if (result != OLX_OK || !r->scene) return result;
  result = olx_scene_find_camera(r->scene, "lit", &r->cameras[0]);
  if (result == OLX_OK) result = olx_scene_find_camera(r->scene, "dark", &r->cameras[1]);
  if (result != OLX_OK) return result;
  r->camera_count = 2;
  olx_render_settings settings = bench_path_settings(r->b);
  settings.spp *= 4; // little light comes through
  result = bench_reference(r->b, r->scene, r->cameras, 2, &settings, bounces(r) + 1, &r->reference);
  for (uint32_t way = 0; way < way_count(r) && result == OLX_OK; ++way) {
    r->placed = way == 0;
    bench_field made;
    bench_images images = {0};
    result = bake(r, 0, false, &made);
    if (result == OLX_OK) result = render(r, made.field, &images);
    if (result == OLX_OK) {
      const double lit = camera_light(r->reference, 0), truth = camera_light(r->reference, 1);
      const double more = camera_light(&images, 1) - truth;
      FINDINGS_ROW(&r->b->found, r->leaks, TEXT_CELL(wall), TEXT_CELL(where(r)), NUMBER_CELL(truth / lit),
                   NUMBER_CELL(more / lit), NUMBER_CELL(truth > 0.0 ? more / truth : NAN));
    }
    bench_images_free(&images);
    bench_field_close(&made);
  }
  return result;
}

static olx_result run_leaks(surface_run *r) {
  static const struct {
    const char *scene, *wall;
    bool quick;
  } walls[] = {{"builtin:two-rooms-sealed", "whole", true},
               {"builtin:two-rooms-gap:0.1", "a gap of 0.1 m", false},
               {"builtin:two-rooms-gap:0.2", "a gap of 0.2 m", true},
               {"builtin:two-rooms-gap:0.4", "a gap of 0.4 m", false},
               {"builtin:two-rooms-gap:0.8", "a gap of 0.8 m", false},
               {"builtin:two-rooms-gap:1.6", "a gap of 1.6 m", false}};
  olx_result result = OLX_OK;
  for (size_t i = 0; i < sizeof walls / sizeof *walls && result == OLX_OK; ++i) {
    if (r->b->options->quick && !walls[i].quick) continue;
    r->name = walls[i].scene;
    result = run_leak(r, walls[i].wall);
  }
  return result;
}

olx_result run_surfaces(bench *b) {
  surface_run r = {.b = b};
  r.light = FINDINGS_TABLE(&b->found, "light", "Indirect light against the path tracer, default settings", light_columns,
                           light_plots);
  r.fields = FINDINGS_TABLE(&b->found, "fields", "The fields, irradiance at points, and bakes that repeat themselves",
                            field_columns, field_plots);
  r.leaks = FINDINGS_TABLE(&b->found, "leaks", "Light behind walls and through gaps", leak_columns, leak_plots);
  olx_result result = run_leaks(&r);
  const size_t count = b->options->quick ? QUICK_SCENES : sizeof scenes / sizeof *scenes;
  for (size_t i = 0; i < count && result == OLX_OK; ++i) {
    r.name = scenes[i];
    result = run_scene(&r);
  }
  return result;
}
