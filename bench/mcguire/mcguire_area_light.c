// Repeats Figure 14 of McGuire et al. 2017: a lamp with an area, its shadow and its reflection, without direct
// lighting.
#include "experiment_list.h"

enum { FRAMES = 64, DIRECT_SAMPLES = 64, GATHERED = 16 };

static const bench_column columns[] = {
    {"lamp", "lamp", BENCH_NAME, NULL, "sampled by direct lighting, or met by the rays that gather"},
    {"mode", "mode", BENCH_NAME, NULL, "16 rays a lobe and camera sample; or one ray a frame, denoised over 64 frames"},
    {.kind = BENCH_DIFFERENCE},
    {"direct_share", "share of direct light", BENCH_QUALITY, "%", "in the picture, of that in the reference"},
    {"seconds", "picture", BENCH_TIME, "s", "processor time of all passes"},
};

static const bench_plot plots[] = {{.caption = "Error of the picture", .y = "relative_mse"}};

static double direct_light(const bench_images *images) {
  const olx_image *image = &images->half[0][0];
  const size_t pixels = (size_t)image->width * image->height;
  double sum = 0.0;
  for (size_t i = 0; i < pixels; ++i) {
    const olx_vec3 light = image->layers[OLX_LAYER_DIRECT][i];
    sum += (double)light.x + (double)light.y + (double)light.z;
  }
  return sum;
}

static bench_way make_way(const bench *b, const olx_field *field, bool traced, bool denoised) {
  static const char *const names[2][2] = {{"sampled, gathered", "sampled, denoised"},
                                          {"traced, gathered", "traced, denoised"}};
  bench_way way = {.name = names[traced][denoised], .field = field, .settings = bench_cage_settings(b)};
  olx_render_settings *settings = &way.settings;
  settings->centered = true;
  settings->diffuse = OLX_DIFFUSE_TRACED;
  settings->diffuse_samples = settings->glossy_samples = GATHERED;
  settings->sample.emitters = traced;
  if (denoised) {
    settings->spp = DIRECT_SAMPLES;
    way.frames = FRAMES;
  }
  return way;
}

static olx_result measure(bench *b, const olx_scene *scene, const olx_field *field) {
  bench_table *table = FINDINGS_TABLE(&b->found, "lamps", "The whole picture against the path tracer", columns, plots);
  olx_render_settings settings = bench_path_settings(b);
  settings.centered = true;
  olx_camera camera;
  bench_images *reference, images[4] = {0};
  bench_shown shown[4];
  olx_result result = olx_scene_find_camera(scene, NULL, &camera);
  if (result == OLX_OK) result = bench_reference(b, scene, &camera, 1, &settings, bench_bounces(b) + 1, &reference);
  for (uint32_t i = 0; i < 4 && result == OLX_OK; ++i) {
    const bool traced = i < 2, denoised = i % 2 == 0;
    const bench_way way = make_way(b, field, traced, denoised);
    bench_quality quality;
    shown[i] = (bench_shown){.way = way.name, .images = &images[i]};
    result = bench_pictures(b, scene, &camera, 1, &way, &images[i]);
    if (result == OLX_OK) result = bench_compare(b, &images[i], reference, BENCH_BEAUTY, 0, &quality);
    if (result != OLX_OK) break;
    const olx_render_stats *stats = &images[i].stats;
    bench_cell cells[BENCH_DIFFERENCE_COLUMNS];
    bench_quality_cells(&quality, cells);
    FINDINGS_ROW(&b->found, table, TEXT_CELL(traced ? "traced" : "sampled"),
                 TEXT_CELL(denoised ? "denoised" : "gathered"), DIFFERENCE_CELLS(cells),
                 NUMBER_CELL(direct_light(&images[i]) / direct_light(reference)),
                 NUMBER_CELL(0.5 * (stats->direct_seconds + stats->diffuse_seconds + stats->glossy_seconds +
                                    stats->denoise_seconds)));
  }
  if (result == OLX_OK) result = bench_show(b, "area-light", OLX_LAYER_BEAUTY, shown, 4, reference, 0);
  for (uint32_t i = 0; i < 4; ++i) bench_images_free(&images[i]);
  return result;
}

olx_result run_mcguire_area_light(bench *b) {
  const bool quick = b->options->quick;
  const bench_probes probes = {.grid = {4, 3, 4}, .texels = quick ? 64 : 256};
  bench_bake bake = bench_bake_settings(b, false);
  olx_scene *scene;
  olx_result result = bench_scene(b, "builtin:area-light", &scene);
  if (result == OLX_OK) result = olx_scene_probe_grid(scene, probes.grid, &bake.irradiance_grid);
  if (result != OLX_OK) return result;
  bench_field made;
  result = bench_bake_field(b, scene, &probes, &bake, &made);
  if (result == OLX_OK) result = measure(b, scene, made.field);
  bench_field_close(&made);
  return result;
}
