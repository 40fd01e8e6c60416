// Compares indirect light in every mode of a renderer where modes differ most: at surfaces that emit, thin objects
// before others, and dark corners.
#include "surfaces.h"

#include <math.h>
#include <stdio.h>

enum { FRAMES = 64, QUICK_FRAMES = 4, CORNER = 4, PATHS = 4, QUICK_PATHS = 1 };

// Blocks of pixels darker than this share of the image's mean count as dark corners.
static const double CORNER_SHARE = 0.5;

static const bench_column columns[] = {
    {"scene", "scene", BENCH_NAME, NULL, NULL},
    {"camera", "camera", BENCH_NAME, NULL, NULL},
    {"mode", "mode", BENCH_NAME, NULL, "how diffuse light is had"},
    {"diffuse_relative_mse", "diffuse: relative MSE", BENCH_QUALITY, NULL, "of indirect diffuse light"},
    {"diffuse_bias", "bias", BENCH_QUALITY, "%", "of indirect diffuse light"},
    {"bright", "brightest block", BENCH_QUALITY, NULL, "light over the reference's in 8 x 8 pixels, at most"},
    {"dark", "darkest block", BENCH_QUALITY, NULL, "light over the reference's in 8 x 8 pixels, at least"},
    {"slit", "slit", BENCH_QUALITY, NULL,
     "what 4 x 4 pixels have too much, over the picture's mean, at most, where the reference has less than half its "
     "mean"},
    {"glossy_bias", "glossy: bias", BENCH_QUALITY, "%", "of indirect glossy light"},
};

static const bench_plot plots[] = {
    {"Error of indirect diffuse light", NULL, "diffuse_relative_mse", NULL, false, true}};

void surface_mode_table(surface_run *r) {
  r->modes = FINDINGS_TABLE(&r->b->found, "modes", "Indirect light in every mode, placed probes", columns, plots);
}

bench_way surface_mode(const surface_run *r, const olx_field *field, uint32_t mode) {
  static const char *const names[SURFACE_MODES] = {"surface", "irradiance probes", "traced", "denoised"};
  static const olx_diffuse diffuse[SURFACE_MODES] = {OLX_DIFFUSE_SURFACE, OLX_DIFFUSE_IRRADIANCE, OLX_DIFFUSE_TRACED,
                                                     OLX_DIFFUSE_TRACED};
  const bool quick = r->b->options->quick;
  bench_way way = {.name = names[mode], .field = field, .settings = bench_field_settings(r->b)};
  way.settings.diffuse = diffuse[mode];
  way.settings.centered = true;
  way.settings.spp = 1;
  if (quick) way.settings.diffuse_samples = 16;
  if (mode == 3) way.frames = quick ? QUICK_FRAMES : FRAMES;
  return way;
}

// Returns the greatest excess of light in a dark corner, relative to the mean light of the reference; NaN where nothing
// is dark.
static double find_slit(const olx_image *image, const olx_image *reference) {
  const double mean = surface_mean_light(reference);
  double most = NAN;
  for (uint32_t top = 0; top + CORNER <= image->height; top += CORNER) {
    for (uint32_t left = 0; left + CORNER <= image->width; left += CORNER) {
      const double truth = surface_block_light(reference, left, top, CORNER);
      if (truth < CORNER_SHARE * mean)
        most = fmax(most, (surface_block_light(image, left, top, CORNER) - truth) / mean);
    }
  }
  return most;
}

static olx_result add_mode(const surface_run *r, const char *mode, bench_images *images) {
  for (uint32_t c = 0; c < r->camera_count; ++c) {
    const olx_image *image = bench_images_mean(images, c), *reference = bench_images_mean(r->reference, c);
    if (!image || !reference) return OLX_ERROR_MEMORY;
    const bench_error diffuse = bench_error_of(images, r->reference, BENCH_DIFFUSE, c),
                      glossy = bench_error_of(images, r->reference, BENCH_GLOSSY, c);
    double dark, bright;
    surface_compare_blocks(image, reference, &dark, &bright);
    FINDINGS_ROW(&r->b->found, r->modes, TEXT_CELL(bench_scene_title(r->name)), TEXT_CELL(r->cameras[c].name),
                 TEXT_CELL(mode), NUMBER_CELL(diffuse.relative_mse), NUMBER_CELL(diffuse.bias), NUMBER_CELL(bright),
                 NUMBER_CELL(dark), NUMBER_CELL(find_slit(image, reference)),
                 NUMBER_CELL(glossy.reference_mean > 0.0 ? glossy.bias : NAN));
  }
  return OLX_OK;
}

static olx_result show(const surface_run *r, const bench_way *ways, bench_images *images) {
  for (uint32_t c = 0; c < r->camera_count; ++c) {
    char view[128];
    bench_shown shown[SURFACE_MODES];
    snprintf(view, sizeof view, "%s, %s: every mode", bench_scene_title(r->name), r->cameras[c].name);
    for (uint32_t m = 0; m < SURFACE_MODES; ++m)
      shown[m] = (bench_shown){.way = ways[m].name, .images = &images[m], .camera = c};
    const olx_result result = bench_show(r->b, view, OLX_LAYER_INDIRECT_DIFFUSE, shown, SURFACE_MODES, r->reference, c);
    if (result != OLX_OK) return result;
  }
  return OLX_OK;
}

olx_result surface_add_modes(const surface_run *run, const olx_field *field, const char *camera) {
  surface_run own = *run, *r = &own;
  olx_result result = camera ? surface_keep_cameras(r, 1, &camera) : OLX_OK;
  if (result == OLX_OK) result = surface_reference(r, r->b->options->quick ? QUICK_PATHS : PATHS, true);
  bench_way ways[SURFACE_MODES];
  bench_images images[SURFACE_MODES] = {0};
  for (uint32_t m = 0; m < SURFACE_MODES && result == OLX_OK; ++m) {
    ways[m] = surface_mode(r, field, m);
    result = bench_pictures(r->b, r->scene, r->cameras, r->camera_count, &ways[m], &images[m]);
    if (result == OLX_OK) result = add_mode(r, ways[m].name, &images[m]);
  }
  if (result == OLX_OK) result = show(r, ways, images);
  for (uint32_t m = 0; m < SURFACE_MODES; ++m) bench_images_free(&images[m]);
  return result;
}

// Evaluates the irradiance volume at points of free space, because it has no images.
static olx_result add_volume(const surface_run *r, const olx_field *field) {
  const bool quick = r->b->options->quick;
  olx_audit_settings settings = olx_audit_settings_default();
  settings.threads = r->b->options->threads;
  settings.rays = settings.points = 100;
  settings.space_points = quick ? 50 : 2000;
  settings.spp = quick ? 64 : 1024;
  olx_audit audit;
  bench_progress(r->b, "audit of %s", r->name);
  const olx_result result = olx_audit_field(r->scene, field, &settings, &r->b->progress, &audit);
  if (result != OLX_OK) return result;
  const olx_audit_points *volume = &audit.space_volume;
  FINDINGS_ROW(&r->b->found, r->modes, TEXT_CELL(bench_scene_title(r->name)), TEXT_CELL("free space"),
               TEXT_CELL("irradiance volume"), NUMBER_CELL(volume->count ? volume->relative_mse : NAN),
               NUMBER_CELL(volume->count ? volume->bias : NAN), NO_CELL, NO_CELL, NO_CELL, NO_CELL);
  return OLX_OK;
}

olx_result surface_all_modes(surface_run *r) {
  if (!surface_wants(r, true)) return OLX_OK;
  bench_field made;
  olx_result result = surface_bake(r, 0, true, &made);
  if (result == OLX_OK) result = surface_add_modes(r, made.field, r->what);
  if (result == OLX_OK) result = add_volume(r, made.field);
  bench_field_close(&made);
  return result;
}
