// Compares irradiance stored as spherical harmonics with octahedral maps of it (McGuire et al. 2017, section 7).
#include "experiment_list.h"

#include <octalux/sample.h>

#include <math.h>
#include <stdio.h>

enum { MOST_SIZES = 3, FORMS = OLX_IRRADIANCE_SH3 + 1, MOST_WAYS = MOST_SIZES * FORMS, DIRECTIONS = 1024, CAGE = 8 };

typedef struct sh_scene {
  const char *name, *camera, *dark; // dark: a camera where no light arrives, or NULL
  uint32_t grid[3];
} sh_scene;

static const sh_scene scenes[] = {
    {"builtin:cornell", NULL, NULL, {3, 3, 3}},        {"builtin:two-rooms-sealed", "lit", "dark", {4, 2, 2}},
    {"builtin:labyrinth", "chamber", NULL, {3, 2, 3}}, {"sponza", "aisle", NULL, {8, 2, 4}},
    {"living-room", "sofa", NULL, {4, 4, 4}},
};
enum { SCENES = sizeof scenes / sizeof *scenes };

static const bench_column columns[] = {
    {"scene", "scene", BENCH_NAME, NULL, NULL},
    {"irradiance", "irradiance", BENCH_NAME, NULL, NULL},
    {"texels", "moments", BENCH_NAME, NULL,
     "texels of the maps of distance moments, and of irradiance where it has maps"},
    {"bytes", "irradiance a probe", BENCH_COUNT, "bytes", "as stored, borders included"},
    {"all_bytes", "with moments", BENCH_COUNT, "bytes", NULL},
    {"filtered", "filtered reads", BENCH_COUNT, NULL, "a pixel, of four texels each, from the eight probes of a cage"},
    {"words", "words", BENCH_COUNT, NULL, "of four bytes, read beside them"},
    {"read_bytes", "read", BENCH_COUNT, "bytes", "a pixel, in all"},
    {.kind = BENCH_DIFFERENCE},
    {"dark_over_lit_share", "leak", BENCH_QUALITY, "%",
     "mean light of the room that gets none over that of the lit room"},
    {"negative_share", "negative", BENCH_QUALITY, "%",
     "directions in which a probe by itself holds irradiance below 0"},
    {"undershoot_share", "undershoot", BENCH_QUALITY, "%", "the furthest below 0, over the most that this probe holds"},
    {"ms", "diffuse pass", BENCH_TIME, "ms", "processor time of a million pixels, one sample each"},
    {"bake_s", "bake", BENCH_TIME, "s", "processor time"},
};

static const bench_plot plots[] = {
    {.caption = "Error against memory",
     .x = "all_bytes",
     .y = "relative_mse",
     .series = "irradiance",
     .log_x = true,
     .log_y = true},
    {.caption = "Error of the indirect light", .y = "relative_mse"},
};

static const char *const form_names[FORMS] = {"octahedral", "sh2", "sh3"};

typedef struct study {
  bench *b;
  const sh_scene *wanted;
  olx_scene *scene;
  olx_camera cameras[2];
  uint32_t camera_count;
  bench_images *reference;
  bench_table *table;
} study;

// The negative irradiance of probes, before interpolation and clamping.
typedef struct ringing {
  double negative, undershoot;
} ringing;

// Returns direction i of a spiral, whose directions are spread evenly.
static olx_vec3 spread_direction(uint32_t i) {
  const double y = 1.0 - (2.0 * i + 1.0) / DIRECTIONS, around = 2.399963229728653 * i, r = sqrt(1.0 - y * y);
  return (olx_vec3){(float)(r * cos(around)), (float)y, (float)(r * sin(around))};
}

static ringing find_ringing(const bench_field *made) {
  double directions = 0.0, negative = 0.0, undershoot = 0.0;
  for (uint32_t probe = 0; probe < made->info.irradiance.probe_count; ++probe) {
    if (olx_field_irradiance_probe_buried(made->field, probe)) continue;
    double least = 0.0, most = 0.0;
    for (uint32_t i = 0; i < DIRECTIONS; ++i) {
      const olx_vec3 e = olx_probe_irradiance(made->field, probe, spread_direction(i));
      const double mean = ((double)e.x + (double)e.y + (double)e.z) / 3.0;
      least = fmin(least, mean);
      most = fmax(most, mean);
      negative += mean < 0.0;
      directions += 1.0;
    }
    if (most > 0.0) undershoot = fmax(undershoot, -least / most);
  }
  return (ringing){negative / fmax(directions, 1.0), undershoot};
}

static olx_result add_row(const study *s, olx_irradiance_form form, const bench_field *made, bench_images *images) {
  bench_quality quality;
  const olx_result result = bench_compare(s->b, images, s->reference, BENCH_DIFFUSE, 0, &quality);
  if (result != OLX_OK) return result;
  const olx_field_info *info = &made->info;
  const double probes = info->irradiance.probe_count, bytes = (double)info->bytes.irradiance / probes;
  const double words = form == OLX_IRRADIANCE_OCTAHEDRAL ? 0.0 : CAGE * bytes / 4.0;
  const double filtered = form == OLX_IRRADIANCE_OCTAHEDRAL ? 2 * CAGE : CAGE;
  const double dark = s->camera_count > 1 ? bench_error_of(images, s->reference, BENCH_DIFFUSE, 1).mean : NAN;
  const ringing rings = find_ringing(made);
  const olx_image *image = &images->half[0][0];
  const double samples = 2.0 * s->camera_count * image->width * image->height * bench_spp(s->b);
  char texels[16];
  snprintf(texels, sizeof texels, "%u\u00b2", info->irradiance.size);
  bench_cell cells[BENCH_DIFFERENCE_COLUMNS];
  bench_quality_cells(&quality, cells);
  FINDINGS_ROW(&s->b->found, s->table, TEXT_CELL(bench_scene_title(s->wanted->name)), TEXT_CELL(form_names[form]),
               TEXT_CELL(texels), NUMBER_CELL(bytes), NUMBER_CELL(bytes + (double)info->bytes.moments / probes),
               NUMBER_CELL(filtered), NUMBER_CELL(words), NUMBER_CELL(16.0 * filtered + 4.0 * words),
               DIFFERENCE_CELLS(cells), NUMBER_CELL(dark / quality.error.mean), NUMBER_CELL(rings.negative),
               NUMBER_CELL(rings.undershoot), NUMBER_CELL(1e9 * images->stats.diffuse_seconds / samples),
               NUMBER_CELL(made->bake_seconds));
  return OLX_OK;
}

static olx_result run_way(const study *s, olx_irradiance_form form, uint32_t size, const char *name,
                          bench_images *images) {
  const uint32_t *grid = s->wanted->grid;
  const bench_probes probes = {.grid = {grid[0], grid[1], grid[2]}, .texels = 8}; // light field maps are not read
  bench_bake bake = bench_bake_settings(s->b, false);
  bake.irradiance_size = size;
  bake.form = form;
  olx_result result = olx_scene_probe_grid(s->scene, grid, &bake.irradiance_grid);
  if (result != OLX_OK) return result;
  bench_field made;
  result = bench_bake_field(s->b, s->scene, &probes, &bake, &made);
  if (result == OLX_OK) {
    const bench_way way = {.name = name, .field = made.field, .settings = bench_cage_settings(s->b)};
    result = bench_pictures(s->b, s->scene, s->cameras, s->camera_count, &way, images);
  }
  if (result == OLX_OK) result = add_row(s, form, &made, images);
  bench_field_close(&made);
  return result;
}

static olx_result run_scene(study *s) {
  static const uint32_t fine[] = {8, 32, 128}, rough[] = {8, 16};
  const uint32_t *sizes = s->b->options->quick ? rough : fine, size_count = s->b->options->quick ? 2 : MOST_SIZES;
  const uint32_t count = size_count * FORMS;
  const olx_render_settings settings = bench_path_settings(s->b);
  bench_images images[MOST_WAYS] = {0};
  bench_shown shown[MOST_WAYS];
  char names[MOST_WAYS][32], view[96];
  olx_result result =
      bench_reference(s->b, s->scene, s->cameras, s->camera_count, &settings, bench_bounces(s->b) + 1, &s->reference);
  for (uint32_t i = 0; i < count && result == OLX_OK; ++i) {
    const olx_irradiance_form form = (olx_irradiance_form)(i % FORMS);
    const uint32_t size = sizes[size_count - 1 - i / FORMS]; // the finest comes first, beside the reference
    snprintf(names[i], sizeof names[i], "%s, %u\u00b2", form_names[form], size);
    shown[i] = (bench_shown){.way = names[i], .images = &images[i]};
    result = run_way(s, form, size, names[i], &images[i]);
  }
  snprintf(view, sizeof view, "%.40s, %.40s", bench_scene_title(s->wanted->name), s->cameras[0].name);
  if (result == OLX_OK) result = bench_show(s->b, view, OLX_LAYER_INDIRECT_DIFFUSE, shown, count, s->reference, 0);
  for (uint32_t i = 0; i < count; ++i) bench_images_free(&images[i]);
  return result;
}

olx_result run_sh(bench *b) {
  study s = {.b = b};
  s.table = FINDINGS_TABLE(&b->found, "forms", "Irradiance as maps and as spherical harmonics", columns, plots);
  for (uint32_t i = 0; i < SCENES; ++i) {
    s.wanted = &scenes[i];
    if (bench_leaves_out(b, scenes[i].name)) continue;
    olx_result result = bench_scene(b, scenes[i].name, &s.scene);
    if (result == OLX_OK && !s.scene) continue;
    s.camera_count = scenes[i].dark ? 2 : 1;
    if (result == OLX_OK) result = olx_scene_find_camera(s.scene, scenes[i].camera, &s.cameras[0]);
    if (result == OLX_OK && scenes[i].dark) result = olx_scene_find_camera(s.scene, scenes[i].dark, &s.cameras[1]);
    if (result == OLX_OK) result = run_scene(&s);
    if (result != OLX_OK) return result;
  }
  return OLX_OK;
}
