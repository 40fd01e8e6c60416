// Measures errors of both indirect layers, camera by camera, for placed probes and for the scene's grid, and the spread
// between two bakes.
#include "surfaces.h"

#include <math.h>
#include <stdio.h>

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
    {"bakes_rms", "two bakes", BENCH_QUALITY, "%", "RMS difference of indirect diffuse light, over its mean"},
};

static const bench_column field_columns[] = {
    {"scene", "scene", BENCH_NAME, NULL, NULL},
    {"probes", "probes", BENCH_NAME, NULL, "where they stand"},
    {"count", "count", BENCH_COUNT, NULL, "light field probes"},
    {"mib", "field", BENCH_COUNT, "MiB", "the file"},
    {"stored", "stored", BENCH_QUALITY, "%", "points of surfaces whose light is stored"},
    {"stored_relative_mse", "relative MSE", BENCH_QUALITY, NULL, "of irradiance at those points"},
    {"fallen_back_relative_mse", "else", BENCH_QUALITY, NULL,
     "relative MSE where the irradiance volume answers instead"},
    {"space_relative_mse", "in space", BENCH_QUALITY, NULL, "relative MSE of the irradiance volume in free space"},
    {"probes_relative_mse", "by probes", BENCH_QUALITY, NULL, "relative MSE of irradiance probes in free space"},
    {"bakes_rms", "two bakes", BENCH_QUALITY, "%",
     "RMS difference of indirect diffuse light, over its mean, all cameras"},
    {"diffuse_ns", "diffuse pass", BENCH_TIME, "ns", "processor time a point, light stored at surfaces"},
    {"irradiance_ns", "by probes", BENCH_TIME, "ns", "the same from irradiance probes, in turns with it"},
    {"glossy_us", "glossy ray", BENCH_TIME, "\u00b5s", "processor time"},
    {"place_s", "place", BENCH_TIME, "s", "processor time"},
    {"bake_s", "bake", BENCH_TIME, "s", "processor time"},
};

static const bench_plot light_plots[] = {
    {"Error of indirect diffuse light", NULL, "diffuse_relative_mse", NULL, false, true}};
static const bench_plot field_plots[] = {{"Two bakes of a scene", NULL, "bakes_rms", NULL, false, false}};

void surface_light_tables(surface_run *r) {
  r->light = FINDINGS_TABLE(&r->b->found, "light", "Indirect light against the path tracer, default settings",
                            light_columns, light_plots);
  r->fields =
      FINDINGS_TABLE(&r->b->found, "fields", "The fields, irradiance at points, and bakes that repeat themselves",
                     field_columns, field_plots);
}

static olx_result render(const surface_run *r, const olx_field *field, bench_images *images) {
  bench_way way = {.name = surface_where(r), .field = field, .settings = bench_field_settings(r->b)};
  way.settings.diffuse = OLX_DIFFUSE_SURFACE;
  return bench_pictures(r->b, r->scene, r->cameras, r->camera_count, &way, images);
}

// Sums of squared differences of two bakes' pixels, and of light.
typedef struct bakes_sum {
  double squares, light, pixels;
} bakes_sum;

static double rms_of(const bakes_sum *s) { return s->light > 0.0 ? sqrt(s->squares * s->pixels) / s->light : NAN; }

static bakes_sum compare_two(const olx_image *a, const olx_image *b) {
  bakes_sum sum = {.pixels = (double)a->width * a->height};
  for (uint32_t i = 0; i < a->width * a->height; ++i) {
    const double one = surface_block_light(a, i % a->width, i / a->width, 1),
                 two = surface_block_light(b, i % b->width, i / b->width, 1);
    sum.squares += (one - two) * (one - two);
    sum.light += one;
  }
  return sum;
}

// Computes the RMS difference of the images of two fields relative to their mean, for each camera and finally for all.
// The report of the other field, a bake with default settings and another seed, stays in *other.
static olx_result compare_bakes(const surface_run *r, bench_images *images, bench_field *other,
                                double rms[BENCH_CAMERAS + 1]) {
  bench_images again = {0};
  bakes_sum all = {0};
  olx_result result = surface_bake(r, 1, false, other);
  if (result == OLX_OK) result = render(r, other->field, &again);
  for (uint32_t c = 0; c < r->camera_count && result == OLX_OK; ++c) {
    const olx_image *a = bench_images_mean(images, c), *b = bench_images_mean(&again, c);
    if (!a || !b) {
      result = OLX_ERROR_MEMORY;
      break;
    }
    const bakes_sum one = compare_two(a, b);
    rms[c] = rms_of(&one);
    all = (bakes_sum){all.squares + one.squares, all.light + one.light, all.pixels + one.pixels};
  }
  rms[BENCH_CAMERAS] = rms_of(&all);
  bench_images_free(&again);
  bench_field_close(other);
  return result;
}

static olx_result add_pictures(const surface_run *r, bench_images *images, const double *bakes_rms) {
  for (uint32_t c = 0; c < r->camera_count; ++c) {
    const olx_image *image = bench_images_mean(images, c), *reference = bench_images_mean(r->reference, c);
    if (!image || !reference) return OLX_ERROR_MEMORY;
    const bench_error diffuse = bench_error_of(images, r->reference, BENCH_DIFFUSE, c),
                      glossy = bench_error_of(images, r->reference, BENCH_GLOSSY, c);
    const bool reflects = glossy.reference_mean > 0.0;
    double dark, bright;
    surface_compare_blocks(image, reference, &dark, &bright);
    FINDINGS_ROW(&r->b->found, r->light, TEXT_CELL(bench_scene_title(r->name)), TEXT_CELL(surface_where(r)),
                 TEXT_CELL(r->cameras[c].name), NUMBER_CELL(diffuse.relative_mse), NUMBER_CELL(diffuse.bias),
                 NUMBER_CELL(bright), NUMBER_CELL(dark), NUMBER_CELL(reflects ? glossy.relative_mse : NAN),
                 NUMBER_CELL(reflects ? glossy.bias : NAN), NUMBER_CELL(bakes_rms[c]));
    char view[128];
    snprintf(view, sizeof view, "%s, %s: %s", bench_scene_title(r->name), r->cameras[c].name, surface_where(r));
    const bench_shown shown = {.way = surface_where(r), .images = images, .camera = c};
    const olx_result result = bench_show(r->b, view, OLX_LAYER_INDIRECT_DIFFUSE, &shown, 1, r->reference, c);
    if (result != OLX_OK) return result;
  }
  return OLX_OK;
}

static double error_or_none(const olx_audit_points *points) { return points->count ? points->relative_mse : NAN; }

static double share_or_none(const olx_audit *audit) {
  return audit->points.count ? (double)audit->stored.count / (double)audit->points.count : NAN;
}

// Measurements of a field besides its images. `audit` has no points, and the times are NaN, where they are not
// measured.
typedef struct field_measures {
  olx_audit audit;
  double bakes_rms[BENCH_CAMERAS + 1]; // for each camera, and finally for all
  double surface_ns, irradiance_ns;
} field_measures;

static field_measures no_measures(void) {
  field_measures none = {.surface_ns = NAN, .irradiance_ns = NAN};
  for (uint32_t c = 0; c <= BENCH_CAMERAS; ++c) none.bakes_rms[c] = NAN;
  return none;
}

static olx_result audit_points(const surface_run *r, const olx_field *field, olx_audit *audit) {
  const bool quick = r->b->options->quick;
  olx_audit_settings settings = olx_audit_settings_default();
  settings.threads = r->b->options->threads;
  settings.rays = 1000;
  settings.points = quick ? 100 : 2000;
  settings.space_points = quick ? 50 : 2000;
  settings.spp = quick ? 64 : 1024;
  bench_progress(r->b, "audit of %s", r->name);
  return olx_audit_field(r->scene, field, &settings, &r->b->progress, audit);
}

// Adds the rows of a field. `plain` is the field whose size and time are reported.
static void add_field(const surface_run *r, const bench_field *plain, const bench_images *images,
                      const field_measures *m) {
  const olx_render_stats *stats = &images->stats;
  FINDINGS_ROW(&r->b->found, r->fields, TEXT_CELL(bench_scene_title(r->name)), TEXT_CELL(surface_where(r)),
               NUMBER_CELL(plain->info.probes.count), NUMBER_CELL((double)plain->info.bytes.file / 1048576.0),
               NUMBER_CELL(share_or_none(&m->audit)), NUMBER_CELL(error_or_none(&m->audit.stored)),
               NUMBER_CELL(error_or_none(&m->audit.fallen_back)), NUMBER_CELL(error_or_none(&m->audit.space_volume)),
               NUMBER_CELL(error_or_none(&m->audit.space_probes)), NUMBER_CELL(m->bakes_rms[BENCH_CAMERAS]),
               NUMBER_CELL(m->surface_ns), NUMBER_CELL(m->irradiance_ns),
               NUMBER_CELL(stats->field_rays ? 1e6 * stats->glossy_seconds / (double)stats->field_rays : NAN),
               NUMBER_CELL(r->placed ? plain->place_seconds : NAN), NUMBER_CELL(plain->bake_seconds));
}

// Measures a grid for comparison: its images, its size and its time from one bake.
static olx_result run_grid(const surface_run *r) {
  const field_measures none = no_measures();
  bench_images images = {0};
  bench_field made = {.field = NULL};
  olx_result result = surface_bake(r, 0, false, &made);
  if (result == OLX_OK) result = render(r, made.field, &images);
  if (result == OLX_OK) result = add_pictures(r, &images, none.bakes_rms);
  if (result == OLX_OK) add_field(r, &made, &images, &none);
  bench_images_free(&images);
  bench_field_close(&made);
  return result;
}

static olx_result run_placed(const surface_run *r) {
  field_measures measures = no_measures();
  bench_images images = {0};
  bench_field made = {.field = NULL}, plain = {.field = NULL};
  olx_result result = surface_bake(r, 0, true, &made);
  if (result == OLX_OK) result = render(r, made.field, &images);
  if (result == OLX_OK) result = compare_bakes(r, &images, &plain, measures.bakes_rms);
  if (result == OLX_OK) result = add_pictures(r, &images, measures.bakes_rms);
  if (result == OLX_OK) result = audit_points(r, made.field, &measures.audit);
  if (result == OLX_OK) result = surface_times(r, made.field, &measures.surface_ns, &measures.irradiance_ns);
  if (result == OLX_OK) add_field(r, &plain, &images, &measures);
  if (result == OLX_OK && r->what) result = surface_add_modes(r, made.field, r->what);
  bench_images_free(&images);
  bench_field_close(&made);
  return result;
}

olx_result surface_pictures(surface_run *r) {
  olx_result result = surface_reference(r, 1, false);
  for (uint32_t way = 0; way < 2 && result == OLX_OK; ++way) {
    r->placed = way == 0;
    if (!surface_wants(r, r->placed)) continue;
    result = r->placed ? run_placed(r) : run_grid(r);
  }
  return result;
}
