// Repeats Table 6.1 of the dissertation: the memory and the time of light field probes and of the baseline.
#include "capture_ways.h"
#include "experiment_list.h"

#include <math.h>
#include <string.h>

enum { MOST_ROUNDS = 9, MAP_SIDE = 128, MAP_TEXELS = MAP_SIDE * MAP_SIDE };

static const bench_column columns[] = {
    {"method", "method", BENCH_NAME, NULL, NULL},
    {"visibility", "visibility", BENCH_NAME, NULL, "whether light stops at walls"},
    {"texels", "maps", BENCH_NAME, NULL, NULL},
    {"kib", "memory a probe", BENCH_COUNT, "KiB", "as stored in the file, borders included"},
    {"published_kib", "published", BENCH_PUBLISHED, "KB", "Table 6.1"},
    {"texel_bytes", "a texel", BENCH_QUALITY, "bytes", "of a map; published: 36 of light field probes"},
    {"ms", "1920 x 1080", BENCH_TIME, "ms",
     "diffuse and glossy pass, processor time of one core, median of the rounds"},
    {"over_classic", "over classic", BENCH_TIME, NULL, NULL},
    {"published_ms", "published", BENCH_PUBLISHED, "ms", "Table 6.1, on an RTX 2070"},
    {"bake_s", "bake", BENCH_TIME, "s", "classic maps; or everything else"},
};

typedef struct contender {
  const char *name, *visibility, *texels;
  olx_method method;
  olx_diffuse diffuse;
  double kib, published_kib, published_ms;
  double ms[MOST_ROUNDS], median, bake_seconds;
} contender;

static void list_contenders(const bench_field *made, contender list[3]) {
  const olx_field_info *info = &made->info;
  const double kib = 1024.0 * info->irradiance.probe_count;
  const double maps = (double)(info->bytes.irradiance + info->bytes.moments) / kib;
  const double light = (double)(bench_geometry_bytes(info) + bench_light_bytes(info)) / kib;
  const contender all[3] = {
      {.name = "irradiance probes (classic)",
       .visibility = "no",
       .texels = "128\u00b2",
       .method = OLX_METHOD_CLASSIC,
       .kib = (double)info->bytes.classic / kib,
       .published_kib = 149.25,
       .published_ms = 1.1},
      {.name = "light field, prefiltered",
       .visibility = "yes",
       .texels = "128\u00b2",
       .method = OLX_METHOD_FIELD,
       .kib = maps + light,
       .published_kib = 576.0,
       .published_ms = 1.1},
      {.name = "light field, one ray a lobe",
       .visibility = "yes",
       .texels = "128\u00b2",
       .method = OLX_METHOD_FIELD,
       .diffuse = OLX_DIFFUSE_TRACED,
       .kib = maps + light,
       .published_kib = NAN,
       .published_ms = NAN},
  };
  memcpy(list, all, sizeof all);
}

static olx_result time_round(bench *b, const olx_scene *scene, const olx_field *field, const olx_camera *camera,
                             contender *c, uint32_t round) {
  olx_render_settings settings = bench_field_settings(b);
  settings.method = c->method;
  settings.diffuse = c->diffuse;
  settings.spp = settings.diffuse_samples = settings.glossy_samples = settings.threads = 1;
  olx_image image;
  olx_render_stats stats;
  const olx_result result = olx_render(scene, field, camera, &settings, &b->progress, &image, &stats);
  if (result != OLX_OK) return result;
  const double pixels = (double)image.width * image.height;
  c->ms[round] = 1e3 * (stats.diffuse_seconds + stats.glossy_seconds) * 1920.0 * 1080.0 / pixels;
  olx_image_free(&image);
  return OLX_OK;
}

static olx_result compare_costs(bench *b, const olx_scene *scene, const bench_field *made) {
  const uint32_t rounds = b->options->quick ? 3 : MOST_ROUNDS;
  contender list[3];
  list_contenders(made, list);
  olx_camera camera;
  olx_result result = olx_scene_find_camera(scene, "lit", &camera);
  for (uint32_t round = 0; round < rounds; ++round) {
    for (uint32_t i = 0; i < 3 && result == OLX_OK; ++i) {
      result = time_round(b, scene, made->field, &camera, &list[i], round);
    }
  }
  if (result != OLX_OK) return result;
  bench_table *table =
      findings_table(&b->found, "costs", "Cost of a probe and of a picture, two-rooms-sealed, 4x2x2 probes", columns,
                     sizeof columns / sizeof *columns, NULL, 0);
  for (uint32_t i = 0; i < 3; ++i) list[i].median = bench_median(list[i].ms, rounds);
  for (uint32_t i = 0; i < 3; ++i) {
    const contender *c = &list[i];
    const double bake = i == 0 ? made->classic_seconds : i == 1 ? made->bake_seconds - made->classic_seconds : NAN;
    FINDINGS_ROW(&b->found, table, TEXT_CELL(c->name), TEXT_CELL(c->visibility), TEXT_CELL(c->texels),
                 NUMBER_CELL(c->kib), NUMBER_CELL(c->published_kib), NUMBER_CELL(c->kib * 1024.0 / MAP_TEXELS),
                 NUMBER_CELL(c->median), NUMBER_CELL(c->median / list[0].median), NUMBER_CELL(c->published_ms),
                 NUMBER_CELL(bake));
  }
  return OLX_OK;
}

olx_result run_dissertation_table1(bench *b) {
  const bench_probes probes = {.grid = {4, 2, 2}, .texels = MAP_SIDE};
  bench_bake bake = {.irradiance_size = MAP_SIDE, .light_samples = 1, .classic_size = MAP_SIDE};
  olx_scene *scene;
  olx_result result = bench_scene(b, "builtin:two-rooms-sealed", &scene);
  if (result == OLX_OK) result = olx_scene_probe_grid(scene, probes.grid, &bake.irradiance_grid);
  if (result != OLX_OK) return result;
  bench_field made;
  result = bench_bake_field(b, scene, &probes, &bake, &made);
  if (result == OLX_OK) result = compare_costs(b, scene, &made);
  if (result == OLX_OK) result = compare_capture(b, scene, &probes, &bake, &made);
  bench_field_close(&made);
  return result;
}
