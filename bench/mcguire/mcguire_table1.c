// Repeats Table 1 of McGuire et al. 2017: the time that indirect light takes, scene by scene.
#include "experiment_list.h"

#include <math.h>
#include <stdio.h>

enum { MOST_ROUNDS = 5 };

static const bench_column columns[] = {
    {"scene", "scene", BENCH_NAME, NULL, NULL},
    {"grid", "probes", BENCH_NAME, NULL, NULL},
    {"texels", "texels", BENCH_NAME, NULL, "of a light field map"},
    {"diffuse_ms", "Lambertian", BENCH_TIME, "ms",
     "one core, for 1920 x 1080 pixels: irradiance with filtered visibility"},
    {"published_diffuse_ms", "published", BENCH_PUBLISHED, "ms", "GTX 1080, 1920 x 1080"},
    {"glossy_ms", "glossy", BENCH_TIME, "ms", "one core, for 1920 x 1080 pixels: one ray where a surface is glossy"},
    {"published_glossy_ms", "published", BENCH_PUBLISHED, "ms", "GTX 1080, 1920 x 1080"},
    {"glossy_pixels", "glossy pixels", BENCH_QUALITY, "%", "that trace a ray"},
    {"steps", "steps a ray", BENCH_QUALITY, NULL, "texels whose distance is read"},
    {"tried", "probes a ray", BENCH_QUALITY, NULL, NULL},
    {"unresolved", "unresolved", BENCH_QUALITY, "%", "rays that no probe could answer"},
    {"mib", "field", BENCH_COUNT, "MiB", NULL},
    {"texel_bytes", "a texel", BENCH_QUALITY, "bytes",
     "of light field probes: geometry, material, light at surfaces, and radiance as probes saw it"},
    {"bake_s", "bake", BENCH_TIME, "s", "processor time, one further bounce; published: one to two minutes"},
};

static const bench_plot plots[] = {
    {.caption = "Glossy light", .y = "glossy_ms"},
    {.caption = "Lambertian light", .y = "diffuse_ms"},
};

static const struct line {
  const char *scene, *camera;
  uint32_t grid[3], texels;
  bool quick;
  double diffuse_ms, glossy_ms; // published times; NAN: not published
} lines[] = {
    {"builtin:cornell", NULL, {2, 2, 2}, 2048, false, 0.358, 0.0},
    {"builtin:cornell", NULL, {2, 2, 2}, 256, true, 0.302, 0.0},
    {"builtin:cornell-glossy", NULL, {2, 2, 2}, 256, true, NAN, NAN},
    {"sponza", "atrium", {8, 2, 4}, 512, false, 0.332, 0.151},
    {"living-room", "sofa", {4, 4, 4}, 1024, false, 0.293, 4.401},
    {"kitchen", NULL, {4, 4, 4}, 1024, false, 0.358, 9.334},
};

typedef struct timing {
  double diffuse_ms[MOST_ROUNDS], glossy_ms[MOST_ROUNDS];
  olx_render_stats stats;
  double pixels;
} timing;

static olx_result time_passes(bench *b, const olx_scene *scene, const char *camera_name, const olx_field *field,
                              uint32_t rounds, timing *t) {
  olx_camera camera;
  olx_result result = olx_scene_find_camera(scene, camera_name, &camera);
  olx_render_settings settings = bench_cage_settings(b);
  if (!b->options->size[0]) {
    settings.width = b->options->quick ? 96 : 480;
    settings.height = b->options->quick ? 54 : 270;
  }
  settings.spp = settings.glossy_samples = settings.threads = 1;
  t->pixels = (double)settings.width * settings.height;
  for (uint32_t round = 0; round < rounds && result == OLX_OK; ++round) {
    olx_image image;
    result = olx_render(scene, field, &camera, &settings, &b->progress, &image, &t->stats);
    if (result != OLX_OK) break;
    olx_image_free(&image);
    const double scale = 1e3 * 1920.0 * 1080.0 / t->pixels;
    t->diffuse_ms[round] = scale * t->stats.diffuse_seconds;
    t->glossy_ms[round] = t->stats.field_rays > 0 ? scale * t->stats.glossy_seconds : 0.0;
  }
  return result;
}

static olx_result run_line(bench *b, const struct line *l, bench_table *table) {
  const uint32_t rounds = b->options->quick ? 3 : MOST_ROUNDS;
  const bench_probes probes = {.grid = {l->grid[0], l->grid[1], l->grid[2]}, .texels = l->texels};
  bench_bake bake = {.irradiance_size = 128, .light_samples = 1, .bounces = 1};
  olx_scene *scene;
  olx_result result = bench_scene(b, l->scene, &scene);
  if (result != OLX_OK || !scene) return result;
  result = olx_scene_probe_grid(scene, l->grid, &bake.irradiance_grid);
  if (result != OLX_OK) return result;
  bench_field made;
  timing t;
  result = bench_bake_field(b, scene, &probes, &bake, &made);
  if (result == OLX_OK) result = time_passes(b, scene, l->camera, made.field, rounds, &t);
  if (result == OLX_OK) {
    const double rays = t.stats.field_rays > 0 ? (double)t.stats.field_rays : NAN;
    char grid[32], texels[16];
    snprintf(grid, sizeof grid, "%ux%ux%u", l->grid[0], l->grid[1], l->grid[2]);
    snprintf(texels, sizeof texels, "%u\u00b2", l->texels);
    FINDINGS_ROW(&b->found, table, TEXT_CELL(bench_scene_title(l->scene)), TEXT_CELL(grid), TEXT_CELL(texels),
                 NUMBER_CELL(bench_median(t.diffuse_ms, rounds)), NUMBER_CELL(l->diffuse_ms),
                 NUMBER_CELL(bench_median(t.glossy_ms, rounds)), NUMBER_CELL(l->glossy_ms),
                 NUMBER_CELL((double)t.stats.field_rays / t.pixels), NUMBER_CELL((double)t.stats.field_steps / rays),
                 NUMBER_CELL((double)t.stats.field_probes / rays), NUMBER_CELL((double)t.stats.field_unresolved / rays),
                 NUMBER_CELL((double)(made.info.bytes.file - made.info.bytes.selectors) / 1048576.0),
                 NUMBER_CELL(bench_texel_bytes(&made.info)), NUMBER_CELL(made.bake_seconds));
  }
  bench_field_close(&made);
  return result;
}

olx_result run_mcguire_table1(bench *b) {
  bench_table *table = FINDINGS_TABLE(&b->found, "times", "Indirect light, milliseconds", columns, plots);
  for (size_t i = 0; i < sizeof lines / sizeof *lines; ++i) {
    if (b->options->quick && !lines[i].quick) {
      if (!bench_leaves_out(b, lines[i].scene))
        findings_skip(&b->found, "cornell, 2048\u00b2", "--quick keeps to small maps");
      continue;
    }
    const olx_result result = run_line(b, &lines[i], table);
    if (result != OLX_OK) return result;
  }
  findings_skip(&b->found, "San Miguel", "its model is too large to come along (published: 0.520 and 47.170 ms)");
  return OLX_OK;
}
