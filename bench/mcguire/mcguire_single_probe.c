// Repeats Figure 17 of McGuire et al. 2017: one probe that lights a star-shaped hall.
#include "experiment_list.h"

#include <stdio.h>

enum { GATHERED = 16 };

static const bench_column columns[] = {
    {"grid", "grid", BENCH_NAME, NULL, "of the light field probes and of the irradiance probes"},
    {"diffuse", "diffuse light", BENCH_NAME, NULL, "from irradiance probes, by 16 rays a sample, or from the baseline"},
    {"layer", "layer", BENCH_NAME, NULL, NULL},
    {.kind = BENCH_DIFFERENCE},
};
static const bench_plot plots[] = {{.caption = "Error of the indirect light", .y = "relative_mse"}};

static const bench_column ray_columns[] = {
    {"grid", "grid", BENCH_NAME, NULL, NULL},
    {"unresolved", "unresolved", BENCH_QUALITY, "%", "rays that no probe could answer"},
    {"wrong", "wrong", BENCH_QUALITY, "%", "rays whose answer is not what the triangles give"},
    {"unseen", "unseen", BENCH_QUALITY, "%", "rays that end where no probe sees"},
    {"distance_error", "median error", BENCH_QUALITY, NULL, "of the distance, over the ray's length"},
    {"steps", "steps", BENCH_QUALITY, NULL, "distances read a ray"},
    {"mib", "field", BENCH_COUNT, "MiB", NULL},
    {"texel_bytes", "a texel", BENCH_QUALITY, "bytes",
     "of light field probes: geometry, material, light at surfaces, and radiance as probes saw it"},
};

typedef struct hall {
  bench *b;
  olx_scene *scene;
  olx_camera camera;
  bench_images *reference;
  bench_table *light, *rays;
  bench_shown shown[8];
  char names[8][64];
  bench_images images[8];
  uint32_t count;
} hall;

static const struct way {
  const char *name;
  olx_method method;
  olx_diffuse diffuse;
} ways[] = {
    {"gathered", OLX_METHOD_FIELD, OLX_DIFFUSE_TRACED},
    {"irradiance probes", OLX_METHOD_FIELD, OLX_DIFFUSE_IRRADIANCE},
    {"classic", OLX_METHOD_CLASSIC, OLX_DIFFUSE_IRRADIANCE},
};

static olx_result add_layer(hall *h, const char *grid, const struct way *way, bench_images *images, bench_light light) {
  bench_quality quality;
  const olx_result result = bench_compare(h->b, images, h->reference, light, 0, &quality);
  if (result != OLX_OK) return result;
  bench_cell cells[BENCH_DIFFERENCE_COLUMNS];
  bench_quality_cells(&quality, cells);
  FINDINGS_ROW(&h->b->found, h->light, TEXT_CELL(grid), TEXT_CELL(way->name),
               TEXT_CELL(light == BENCH_DIFFUSE ? "indirect diffuse" : "indirect glossy"), DIFFERENCE_CELLS(cells));
  return OLX_OK;
}

static olx_result add_way(hall *h, const char *grid, const struct way *way, const bench_field *made) {
  bench_images *images = &h->images[h->count];
  char *name = h->names[h->count];
  snprintf(name, sizeof h->names[0], "%s, %s", grid, way->name);
  h->shown[h->count++] = (bench_shown){.way = name, .images = images};
  bench_way wanted = {.name = name, .field = made->field, .settings = bench_cage_settings(h->b)};
  wanted.settings.method = way->method;
  wanted.settings.diffuse = way->diffuse;
  wanted.settings.diffuse_samples = GATHERED;
  olx_result result = bench_pictures(h->b, h->scene, &h->camera, 1, &wanted, images);
  if (result == OLX_OK) result = add_layer(h, grid, way, images, BENCH_DIFFUSE);
  // Gathering differs only in diffuse light.
  if (result == OLX_OK && way->diffuse == OLX_DIFFUSE_IRRADIANCE)
    result = add_layer(h, grid, way, images, BENCH_GLOSSY);
  return result;
}

static olx_result add_rays(hall *h, const char *grid, const bench_field *made) {
  olx_audit_settings settings = olx_audit_settings_default();
  settings.rays = h->b->options->quick ? 20000 : 200000;
  settings.points = 0;
  settings.threads = h->b->options->threads;
  settings.sample.select = OLX_SELECT_CAGE;
  olx_audit audit;
  const olx_result result = olx_audit_field(h->scene, made->field, &settings, &h->b->progress, &audit);
  if (result != OLX_OK) return result;
  const double bytes = (double)(made->info.bytes.file - made->info.bytes.selectors - made->info.bytes.classic);
  FINDINGS_ROW(&h->b->found, h->rays, TEXT_CELL(grid), NUMBER_CELL(audit.rays.unresolved),
               NUMBER_CELL(audit.rays.wrong), NUMBER_CELL(audit.rays.unseen),
               NUMBER_CELL(audit.rays.distance_error_median), NUMBER_CELL(audit.rays.steps_mean),
               NUMBER_CELL(bytes / 1048576.0), NUMBER_CELL(bench_texel_bytes(&made->info)));
  return OLX_OK;
}

// Returns a grid at the centres of as many cells along each side of the scene's bounds.
static olx_grid grid_in(const olx_scene *scene, uint32_t side) {
  const olx_scene_info info = olx_scene_describe(scene);
  const float n = (float)side;
  const olx_vec3 cell = {(info.bounds_max.x - info.bounds_min.x) / n, (info.bounds_max.y - info.bounds_min.y) / n,
                         (info.bounds_max.z - info.bounds_min.z) / n};
  return (olx_grid){.origin = {info.bounds_min.x + 0.5f * cell.x, info.bounds_min.y + 0.5f * cell.y,
                               info.bounds_min.z + 0.5f * cell.z},
                    .spacing = cell,
                    .count = {side, side, side}};
}

static olx_result add_grid(hall *h, uint32_t side) {
  bench_probes probes = {.grid = {side, side, side}, .texels = h->b->options->quick ? 128 : 1024};
  bench_bake bake = bench_bake_settings(h->b, true);
  olx_result result = OLX_OK;
  if (side == 1) result = olx_scene_probe_grid(h->scene, probes.grid, &bake.irradiance_grid);
  else bake.irradiance_grid = grid_in(h->scene, side);
  if (result != OLX_OK) return result;
  probes.exact = &bake.irradiance_grid;
  char grid[16];
  snprintf(grid, sizeof grid, "%ux%ux%u", side, side, side);
  bench_field made;
  result = bench_bake_field(h->b, h->scene, &probes, &bake, &made);
  for (uint32_t i = 0; i < sizeof ways / sizeof *ways && result == OLX_OK; ++i)
    result = add_way(h, grid, &ways[i], &made);
  if (result == OLX_OK) result = add_rays(h, grid, &made);
  bench_field_close(&made);
  return result;
}

olx_result run_mcguire_single_probe(bench *b) {
  hall h = {.b = b};
  h.light = FINDINGS_TABLE(&b->found, "light", "Indirect light against the path tracer", columns, plots);
  h.rays = findings_table(&b->found, "rays", "Rays through the field against the triangles", ray_columns,
                          sizeof ray_columns / sizeof *ray_columns, NULL, 0);
  const olx_render_settings settings = bench_path_settings(b);
  olx_result result = bench_scene(b, "builtin:holodeck", &h.scene);
  if (result == OLX_OK) result = olx_scene_find_camera(h.scene, NULL, &h.camera);
  if (result == OLX_OK)
    result = bench_reference(b, h.scene, &h.camera, 1, &settings, bench_bounces(b) + 1, &h.reference);
  if (result == OLX_OK) result = add_grid(&h, 1);
  if (result == OLX_OK) result = add_grid(&h, 2);
  if (result == OLX_OK)
    result = bench_show(b, "holodeck, diffuse", OLX_LAYER_INDIRECT_DIFFUSE, h.shown, h.count, h.reference, 0);
  if (result == OLX_OK) result = bench_show(b, "holodeck, picture", OLX_LAYER_BEAUTY, h.shown, h.count, h.reference, 0);
  for (uint32_t i = 0; i < h.count; ++i) bench_images_free(&h.images[i]);
  return result;
}
