// Measures fields of one scene that differ in the number of probes or texels, and tabulates their errors and sizes side
// by side.
#include "field_sweep.h"

#include <math.h>
#include <stdio.h>

static const bench_column columns[] = {
    {"scene", "scene", BENCH_NAME, NULL, NULL},
    {"grid", "grid", BENCH_NAME, NULL, "of the light field probes and of the irradiance probes"},
    {"texels", "texels", BENCH_NAME, NULL, "of a light field map"},
    {"probes", "probes", BENCH_COUNT, NULL, NULL},
    {"mib", "field", BENCH_COUNT, "MiB", "all maps of the field"},
    {"texel_bytes", "a texel", BENCH_QUALITY, "bytes",
     "of light field probes: geometry, material, light at surfaces, and radiance as probes saw it"},
    {"diffuse_relative_mse", "diffuse: relative MSE", BENCH_QUALITY, NULL, "of indirect diffuse light"},
    {"diffuse_bias", "bias", BENCH_QUALITY, "%", "of indirect diffuse light"},
    {"diffuse_flip", "FLIP", BENCH_QUALITY, NULL, "of indirect diffuse light"},
    {"glossy_relative_mse", "glossy: relative MSE", BENCH_QUALITY, NULL, "of indirect glossy light"},
    {"glossy_bias", "bias", BENCH_QUALITY, "%", "of indirect glossy light"},
    {"glossy_flip", "FLIP", BENCH_QUALITY, NULL, "of indirect glossy light"},
    {"unresolved", "unresolved", BENCH_QUALITY, "%", "glossy rays that no probe could answer"},
    {"diffuse_ms", "diffuse pass", BENCH_TIME, "ms", "processor time of a million pixels, one sample each"},
    {"glossy_us", "glossy ray", BENCH_TIME, "\u00b5s", "processor time"},
    {"bake_s", "bake", BENCH_TIME, "s", "processor time"},
};

typedef struct sweep {
  bench *b;
  const sweep_scene *wanted;
  olx_scene *scene;
  olx_camera camera;
  bench_table *table;
  bench_images *reference;
} sweep;

static olx_result add_row(const sweep *s, const sweep_step *step, const bench_field *made, bench_images *images) {
  bench_quality diffuse, glossy;
  olx_result result = bench_compare(s->b, images, s->reference, BENCH_DIFFUSE, 0, &diffuse);
  if (result == OLX_OK) result = bench_compare(s->b, images, s->reference, BENCH_GLOSSY, 0, &glossy);
  if (result != OLX_OK) return result;
  const olx_field_info *info = &made->info;
  const olx_render_stats *stats = &images->stats;
  char grid[32], texels[16];
  snprintf(grid, sizeof grid, "%ux%ux%u", step->grid[0], step->grid[1], step->grid[2]);
  snprintf(texels, sizeof texels, "%u\u00b2", info->maps.size);
  const olx_image *image = &images->half[0][0];
  const double samples = 2.0 * image->width * image->height * bench_spp(s->b);
  const double rays = stats->field_rays > 0 ? (double)stats->field_rays : NAN;
  FINDINGS_ROW(&s->b->found, s->table, TEXT_CELL(bench_scene_title(s->wanted->scene)), TEXT_CELL(grid),
               TEXT_CELL(texels), NUMBER_CELL(info->probes.count),
               NUMBER_CELL((double)(info->bytes.file - info->bytes.selectors) / 1048576.0),
               NUMBER_CELL(bench_texel_bytes(info)), NUMBER_CELL(diffuse.error.relative_mse),
               NUMBER_CELL(diffuse.error.bias), NUMBER_CELL(diffuse.flip), NUMBER_CELL(glossy.error.relative_mse),
               NUMBER_CELL(glossy.error.bias), NUMBER_CELL(glossy.flip),
               NUMBER_CELL((double)stats->field_unresolved / rays), NUMBER_CELL(1e9 * stats->diffuse_seconds / samples),
               NUMBER_CELL(1e6 * stats->glossy_seconds / rays), NUMBER_CELL(made->bake_seconds));
  return OLX_OK;
}

static olx_result run_step(const sweep *s, const sweep_step *step, const char *name, bench_images *images) {
  const bench_probes probes = {.grid = {step->grid[0], step->grid[1], step->grid[2]}, .texels = step->texels};
  bench_bake bake = bench_bake_settings(s->b, false);
  olx_result result = olx_scene_probe_grid(s->scene, step->grid, &bake.irradiance_grid);
  if (result != OLX_OK) return result;
  bench_field made;
  result = bench_bake_field(s->b, s->scene, &probes, &bake, &made);
  if (result == OLX_OK) {
    const bench_way way = {.name = name, .field = made.field, .settings = bench_cage_settings(s->b)};
    result = bench_pictures(s->b, s->scene, &s->camera, 1, &way, images);
  }
  if (result == OLX_OK) result = add_row(s, step, &made, images);
  bench_field_close(&made);
  return result;
}

static olx_result run_scene(sweep *s, olx_layer layer) {
  bench_images images[SWEEP_STEPS] = {0};
  bench_shown shown[SWEEP_STEPS];
  char names[SWEEP_STEPS][48], view[96];
  const olx_render_settings settings = bench_path_settings(s->b);
  olx_result result = bench_reference(s->b, s->scene, &s->camera, 1, &settings, bench_bounces(s->b) + 1, &s->reference);
  const uint32_t count = s->wanted->step_count;
  for (uint32_t i = 0; i < count && result == OLX_OK; ++i) {
    const sweep_step *step = &s->wanted->steps[i];
    snprintf(names[i], sizeof names[i], "%ux%ux%u, %u\u00b2", step->grid[0], step->grid[1], step->grid[2],
             step->texels);
    // The finest comes first, next to the reference.
    shown[count - 1 - i] = (bench_shown){.way = names[i], .images = &images[i]};
    result = run_step(s, step, names[i], &images[i]);
  }
  snprintf(view, sizeof view, "%s, %s", bench_scene_title(s->wanted->scene), s->camera.name);
  if (result == OLX_OK) result = bench_show(s->b, view, layer, shown, count, s->reference, 0);
  for (uint32_t i = 0; i < count; ++i) bench_images_free(&images[i]);
  return result;
}

olx_result run_sweep(bench *b, const sweep_scene *scenes, uint32_t count, olx_layer layer, const char *caption,
                     const bench_plot *plots, uint32_t plot_count) {
  const uint32_t column_count = sizeof columns / sizeof *columns;
  sweep s = {.b = b};
  s.table = findings_table(&b->found, "fields", caption, columns, column_count, plots, plot_count);
  for (uint32_t i = 0; i < count; ++i) {
    s.wanted = &scenes[i];
    if (bench_leaves_out(b, scenes[i].scene)) continue;
    olx_result result = bench_scene(b, scenes[i].scene, &s.scene);
    if (result == OLX_OK && !s.scene) continue;
    if (result == OLX_OK) result = olx_scene_find_camera(s.scene, scenes[i].camera, &s.camera);
    if (result == OLX_OK) result = run_scene(&s, layer);
    if (result != OLX_OK) return result;
  }
  return OLX_OK;
}
