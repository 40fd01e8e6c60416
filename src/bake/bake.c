// Runs one bake from its settings to its file: places the probes, solves the light of the scene, captures every probe,
// and hands each result to the writer, so that memory never holds the whole field.
#include <octalux/bake.h>

#include "bake/bake_run.h"
#include "bake/bake_settings.h"
#include "bake/bake_work.h"
#include "bake/buried.h"
#include "bake/cost/available.h"
#include "bake/cost/bake_memory.h"
#include "bake/irradiance/gather_bounces.h"
#include "core/hooks.h"
#include "core/result.h"
#include "field/brick_data.h"
#include "scene/emitters.h"
#include "scene/sources.h"

#include <stdio.h>
#include <string.h>
#include <sys/resource.h>

// Places probes at `positions`, or on the grid where `positions` is NULL.
static olx_result place_probes(const olx_grid *grid, const olx_vec3 *positions, uint32_t position_count,
                               olx_probe_list *probes) {
  probes->count = positions ? position_count : grid->count[0] * grid->count[1] * grid->count[2];
  probes->positions = olx_allocate(probes->count, sizeof *probes->positions);
  probes->flags = olx_allocate_zero(probes->count, 1);
  if (!probes->positions || !probes->flags)
    return olx_fail(OLX_ERROR_MEMORY, "bake: out of memory for %u probes", probes->count);
  for (uint32_t i = 0; i < probes->count; i++) {
    probes->positions[i] = positions ? positions[i] : olx_grid_position(grid, i);
  }
  return OLX_OK;
}

static void free_probes(olx_probe_list *probes) {
  olx_release(probes->positions);
  olx_release(probes->flags);
}

// Sets the spacing to 0 along axes with a single probe, where a spacing has no meaning.
static olx_grid without_idle_spacing(olx_grid grid) {
  if (grid.count[0] == 1) grid.spacing.x = 0.0f;
  if (grid.count[1] == 1) grid.spacing.y = 0.0f;
  if (grid.count[2] == 1) grid.spacing.z = 0.0f;
  return grid;
}

static float least_spacing(const olx_grid *grid, float otherwise) {
  const float spacing[3] = {grid->spacing.x, grid->spacing.y, grid->spacing.z};
  float least = otherwise;
  for (uint32_t axis = 0; axis < 3; axis++) {
    if (grid->count[axis] > 1 && spacing[axis] < least) least = spacing[axis];
  }
  return least;
}

olx_field_header olx_bake_header(const olx_bake_run *b) {
  const olx_bake_settings *s = b->context.settings;
  olx_field_header header = {
      .info = {.probes = {.count = b->context.probes.light_field.count, .has_grid = !s->probes, .grid = s->grid},
               .maps = {.size = s->radiance_size,
                        .samples = s->samples,
                        .distance_scale_metres = b->context.distance_scale,
                        .compressed = !s->uncompressed,
                        .geometry_blocks = !s->uncompressed},
               .irradiance.probe_count = b->context.probes.irradiance.count,
               .select_mask = olx_bake_select_mask(s),
               .bounces.count = s->bounces,
               .scene = {.bounds_min = b->context.scene->bounds_min,
                         .bounds_max = b->context.scene->bounds_max,
                         .hash = b->context.scene->hash}},
      .origin = {b->context.scene->origin[0], b->context.scene->origin[1], b->context.scene->origin[2]},
      .probe_positions = b->context.probes.light_field.positions,
      .irradiance_positions = b->context.probes.irradiance.positions,
      .lights = b->lights,
      .light_count = b->context.scene->light_count,
      .classic_table = b->classic_table,
      .volume = b->volume.cells.data,
      .volume_bytes = b->volume.cells.size_bytes,
      .volume_positions = b->volume.cells.positions,
  };
  header.info.volume.probe_count = b->volume.cells.probe_count;
  if (b->context.probes.irradiance.count) {
    header.info.irradiance.grid = s->irradiance_grid;
    header.info.irradiance.size = s->irradiance_size;
    header.info.irradiance.form = s->irradiance_form;
  }
  if (s->classic) {
    header.info.classic.size = s->classic_size;
    header.info.classic.cube_size = s->classic_cube_size;
    header.info.classic.sharpness = (float)b->classic.filter.sharpness;
  }
  header.relight = s->relight;
  for (olx_select select = OLX_SELECT_CAGE; select < OLX_SELECT_STORED; select++) {
    header.select_data[select] = b->selectors.data[select];
    header.select_bytes[select] = b->selectors.size_bytes[select];
  }
  return header;
}

olx_result olx_bake_create_file(olx_bake_run *b, const char *path) {
  const olx_field_header header = olx_bake_header(b);
  return olx_field_writer_create(path, &header, &b->writer);
}

static uint32_t count_buried(const olx_probe_list *probes) {
  uint32_t count = 0;
  for (uint32_t i = 0; i < probes->count; i++) count += probes->flags[i] & OLX_PROBE_BURIED;
  return count;
}

static olx_result find_buried(olx_bake_run *b) {
  uint64_t rays = 0;
  OLX_TRY(olx_find_buried(b->context.scene, &b->context.probes, b->context.settings->threads, &rays));
  b->stats.rays += rays;
  b->stats.buried = count_buried(&b->context.probes.light_field);
  b->stats.irradiance_buried = count_buried(&b->context.probes.irradiance);
  return OLX_OK;
}

static olx_result build_selectors(olx_bake_run *b) {
  const olx_bake_settings *s = b->context.settings;
  const olx_selector_input input = {
      .scene = b->context.scene,
      .positions = b->context.probes.light_field.positions,
      .flags = b->context.probes.light_field.flags,
      .count = b->context.probes.light_field.count,
      .radiance_size = s->radiance_size,
      .map_bytes = olx_light_field_map_bytes(b->context.probes.light_field.count, s->radiance_size),
      .distance_scale = b->context.distance_scale,
      .threads = s->threads,
      .task = &b->context.task};
  olx_task_stage(&b->context.task, "selectors");
  return olx_selectors_build(&input, olx_bake_select_mask(s), &b->selectors);
}

static olx_result gather_solved(olx_bake_run *b) {
  OLX_TRY(olx_gather_look(&b->gather));
  OLX_TRY(olx_gather_solved(&b->gather));
  OLX_TRY(olx_gather_irradiance(&b->gather, 0));
  return b->context.settings->fit ? olx_gather_fit(&b->gather, 0) : OLX_OK;
}

// Gathers the bounces that the settings request, and stops when a bounce no longer adds light.
static olx_result gather_bounces(olx_bake_run *b) {
  OLX_TRY(olx_gather_look(&b->gather));
  OLX_TRY(olx_gather_link(&b->gather));
  for (uint32_t bounce = 0; bounce <= b->context.settings->bounces; bounce++) {
    if (bounce > 0) OLX_TRY(olx_gather_bounce(&b->gather, bounce));
    OLX_TRY(olx_gather_irradiance(&b->gather, bounce));
    if (b->context.settings->fit) OLX_TRY(olx_gather_fit(&b->gather, bounce));
    b->bounces = bounce;
    if (bounce > 0 && !olx_gather_brought_light(&b->gather, bounce)) break;
  }
  olx_gather_skip(&b->gather, b->context.settings->bounces - b->bounces);
  if (b->gather.traces) {
    b->stats.unseen =
        (double)atomic_load(&b->gather.traced.unseen) / fmax(1.0, (double)atomic_load(&b->gather.traced.rays));
  }
  return OLX_OK;
}

static olx_result gather_light(olx_bake_run *b) {
  const olx_bake_settings *s = b->context.settings;
  const double start = olx_seconds();
  OLX_TRY(olx_gather_create(&b->gather, &s->irradiance_grid, s->irradiance_size, s->bounces));
  OLX_TRY(b->gather.light ? gather_solved(b) : gather_bounces(b));
  b->stats.irradiance_seconds = olx_seconds() - start;
  return OLX_OK;
}

static void describe_classic(olx_bake_run *b) {
  const olx_bake_settings *s = b->context.settings;
  const uint32_t sharpness =
      s->classic_sharpness ? s->classic_sharpness : olx_classic_sharpness(s->classic_size, s->classic_cube_size);
  b->classic = (olx_classic_bake){
      .context = &b->context,
      .shade = &b->shade,
      .filter = {.size = s->classic_size,
                 .cube_size = s->classic_cube_size,
                 .sharpness = sharpness,
                 .threads = s->threads},
  };
}

static olx_result make_classic_table(olx_bake_run *b) {
  if (!b->context.settings->classic) return OLX_OK;
  b->classic_table = olx_allocate(OLX_CLASSIC_TABLE_ENTRIES, sizeof *b->classic_table);
  if (!b->classic_table) return olx_fail(OLX_ERROR_MEMORY, "bake: out of memory for a table of reflectances");
  return olx_classic_table_make(b->classic_table, b->context.settings->threads);
}

// A limit on memory leaves no room for rays of another scene.
bool olx_bake_keeps_rays(const olx_bake_run *b) {
  const olx_bake_settings *s = b->context.settings;
  return b->store && s->work.keep && !s->work.parts && !s->memory_limit_bytes;
}

olx_scene_light_settings olx_bake_light_settings(const olx_bake_run *b) {
  const olx_bake_settings *s = b->context.settings;
  olx_scene_light_settings settings = olx_scene_light_settings_default();
  settings.bounces = s->bounces + 1;
  settings.noise = s->noise;
  settings.map_size = s->radiance_size;
  settings.seed = b->shade.seed;
  settings.threads = s->threads;
  settings.store = b->store;
  settings.keep_rays = olx_bake_keeps_rays(b);
  settings.link_folder = b->link_folder;
  return settings;
}

static olx_result solve_light(olx_bake_run *b) {
  if (b->context.settings->light == OLX_LIGHT_REFERENCE) return OLX_OK;
  olx_task_stage(&b->context.task, "light");
  olx_scene_light_settings settings = olx_bake_light_settings(b);
  settings.task = &b->context.task;
  if (settings.keep_rays) OLX_TRY(olx_scene_hash_inputs(b->context.scene, &settings.inputs));
  OLX_TRY(olx_scene_light_create(b->context.scene, &settings, b->context.probes.light_field.positions,
                                 b->context.probes.light_field.flags, b->context.probes.light_field.count, &b->light));
  const olx_scene_light_report report = olx_scene_light_describe(b->light);
  b->stats.rays += report.rays;
  b->stats.reused_rays = report.reused_rays;
  b->stats.surfels = report.surfels;
  b->stats.noise = report.noise;
  b->stats.light_bytes = report.bytes;
  b->stats.light_seconds = report.seconds;
  return OLX_OK;
}

static olx_result make_volume_cells(olx_bake_run *b) {
  b->volume = (olx_volume_bake){.context = &b->context, .seed = b->shade.seed};
  return olx_volume_bake_create(&b->volume, &b->stats);
}

void olx_bake_describe(olx_bake_run *b) {
  const olx_bake_settings *s = b->context.settings;
  b->gather = (olx_gather){.context = &b->context, .shade = &b->shade, .traces = s->bounce_gather == OLX_GATHER_TRACED};
  b->capture = (olx_capture){.context = &b->context, .size = s->radiance_size};
  b->surfaces = (olx_surface_capture){.capture = &b->capture};
  if (s->classic) describe_classic(b);
}

uint64_t olx_bake_units(const olx_bake_run *b) {
  const olx_bake_settings *s = b->context.settings;
  uint64_t units = olx_gather_units(&b->gather, s->bounces, olx_bake_is_solved(s)) +
                   b->context.probes.light_field.count * olx_capture_units(&b->capture);
  if (s->fit) units += olx_surface_fit_units(b->context.probes.irradiance.count, olx_bake_is_solved(s));
  if (s->classic) units += b->context.probes.irradiance.count * olx_classic_bake_units(&b->classic);
  return units;
}

olx_result olx_bake_make_plan(olx_bake_run *b) {
  OLX_TRY(find_buried(b));
  OLX_TRY(build_selectors(b));
  OLX_TRY(make_classic_table(b));
  return make_volume_cells(b);
}

// Ignores missing units in a partial bake, which continues with the stages that do not need them.
static olx_result go_on(olx_bake_run *b, olx_result result) {
  if (result != OLX_ERROR_INCOMPLETE || !olx_unit_store_is_part(b->store)) return result;
  b->incomplete = true;
  return OLX_OK;
}

// Has the later stages read the solved light.
static void use_light(olx_bake_run *b) {
  if (olx_bake_is_solved(b->context.settings)) b->gather.light = b->shade.light = b->light;
  b->surfaces.light = b->light;
}

// Stores the links of the light for relighting. A damaged one was discarded with the steps of the light after it; a
// whole bake computes these again.
static olx_result keep_links(olx_bake_run *b) {
  const olx_result result = olx_bake_relight(b);
  if (result != OLX_ERROR_INCOMPLETE || olx_unit_store_is_part(b->store) || !b->light) return result;
  olx_relight_bake_free(&b->relight);
  b->relight = (olx_relight_bake){0};
  olx_scene_light_free(b->light);
  b->light = NULL;
  OLX_TRY(solve_light(b));
  use_light(b);
  return olx_bake_relight(b);
}

// Runs the stages that read the solved light.
static olx_result run_probes(olx_bake_run *b) {
  OLX_TRY(go_on(b, olx_bake_facts(b)));
  OLX_TRY(go_on(b, olx_volume_bake_write(&b->volume, b->light, b->store, b->writer, &b->stats)));
  OLX_TRY(go_on(b, olx_bake_irradiance(b, gather_light)));
  OLX_TRY(go_on(b, olx_bake_classic(b)));
  OLX_TRY(go_on(b, keep_links(b)));
  OLX_TRY(go_on(b, olx_bake_probes(b)));
  return b->incomplete ? olx_bake_await(b) : OLX_OK;
}

// Runs every stage except committing the file. olx_bake_finish releases what the stages allocated.
static olx_result run(olx_bake_run *b, const char *path) {
  const olx_bake_settings *s = b->context.settings;
  olx_bake_describe(b);
  OLX_TRY(olx_bake_plan(b, olx_bake_make_plan));
  const bool is_part = olx_unit_store_is_part(b->store);
  if (is_part && olx_bake_is_stored(b)) return OLX_OK;
  if (!is_part) OLX_TRY(olx_bake_create_file(b, path));
  OLX_TRY(olx_capture_create(&b->capture));
  if (s->classic) OLX_TRY(olx_classic_bake_create(&b->classic));
  OLX_TRY(solve_light(b));
  use_light(b);
  b->bounces = s->bounces;
  OLX_TRY(olx_surface_capture_create(&b->surfaces));
  b->stats.primary_rays = b->context.probes.light_field.count * olx_capture_units(&b->capture);
  b->gather.quadrature = olx_quadrature_shape(s->irradiance_size);
  b->context.task.total_units = olx_bake_units(b);
  return run_probes(b);
}

olx_result olx_bake_finish(olx_bake_run *b, olx_result result, double start) {
  if (result == OLX_OK && b->writer) {
    const double written = olx_seconds();
    result = olx_field_writer_commit(b->writer, &b->stats.file_bytes);
    b->stats.write_seconds += olx_seconds() - written;
  } else {
    olx_field_writer_discard(b->writer);
  }
  olx_selectors_free(&b->selectors);
  b->stats.raster_seconds = b->capture.cubes.seconds;
  b->stats.raster_rays = atomic_load(&b->capture.recast);
  olx_capture_free(&b->capture);
  olx_surface_capture_free(&b->surfaces);
  olx_scene_light_free(b->light);
  olx_volume_bake_free(&b->volume);
  olx_release(b->lights);
  b->stats.rays += b->capture.rays + atomic_load(&b->surfaces.rays);
  olx_classic_bake_free(&b->classic);
  b->stats.rays += b->relight.rays;
  olx_relight_bake_free(&b->relight);
  olx_release(b->classic_table);
  olx_gather_free(&b->gather);
  b->stats.rays += atomic_load(&b->shade.rays);
  olx_shade_context_end(&b->shade);
  olx_task_end(&b->context.task);
  struct rusage usage;
  free_probes(&b->context.probes.light_field);
  free_probes(&b->context.probes.irradiance);
  getrusage(RUSAGE_SELF, &usage);
  b->stats.peak_memory_bytes = (uint64_t)usage.ru_maxrss * 1024u;
  b->stats.seconds = olx_seconds() - start - b->stats.write_seconds - b->measure_seconds;
  return result;
}

olx_result olx_bake_begin(olx_bake_run *b, const olx_progress *progress) {
  b->context.distance_scale = olx_length(olx_sub(b->context.scene->bounds_max, b->context.scene->bounds_min));
  olx_task_begin(&b->context.task, progress, "probes", 1);
  olx_shade_context_begin(&b->shade, b->context.scene, b->context.settings->seed);
  const float spacing = least_spacing(&b->context.settings->irradiance_grid, b->context.distance_scale);
  b->shade.share_distance = 0.01f * spacing;
  OLX_TRY(place_probes(&b->context.settings->grid, b->context.settings->probes, b->context.settings->probe_count,
                       &b->context.probes.light_field));
  if (olx_bake_keeps_probe_light(b->context.settings))
    OLX_TRY(place_probes(&b->context.settings->irradiance_grid, NULL, 0, &b->context.probes.irradiance));
  return OLX_OK;
}

static olx_result bake_scene(olx_bake_run *b, const char *path, const olx_progress *progress) {
  const double start = olx_seconds();
  olx_result result = olx_bake_begin(b, progress);
  if (result == OLX_OK) result = run(b, path);
  return olx_bake_finish(b, result, start);
}

static olx_bake_settings without_idle_spacings(const olx_bake_settings *settings) {
  olx_bake_settings used = *settings;
  used.grid = without_idle_spacing(settings->grid);
  used.irradiance_grid = without_idle_spacing(settings->irradiance_grid);
  return used;
}

// path: of the field; NULL for a part, which writes none, and whose messages name its folder.
static olx_result check_bake(const olx_scene *scene, const olx_bake_settings *settings, const char *path) {
  OLX_TRY(olx_bake_check_machine(scene, settings, path ? path : settings->work.folder));
  return path ? olx_output_check(path, false) : OLX_OK;
}

olx_result olx_bake_prepare(const olx_scene *scene, const olx_bake_settings *settings, const char *path) {
  olx_bake_settings used = without_idle_spacings(settings);
  olx_unit_store *store;
  used.work.part = used.work.parts = 0;
  OLX_TRY(check_bake(scene, &used, path));
  OLX_TRY(olx_scene_check_output(scene, path));
  if (used.work.folder) OLX_TRY(olx_bake_check_apart(path, used.work.folder));
  OLX_TRY(olx_bake_work_open(scene, &used, &store));
  olx_unit_store_close(store, false);
  return OLX_OK;
}

// Returns the largest channel of what lights bring by themselves: the irradiance of all suns together, or the radiance
// of the sky or of a shining material. A sky with an image does not count.
static float brightest_light(const olx_scene *scene) {
  olx_vec3 suns = {0};
  float emission = olx_max3(scene->environment.texels ? olx_splat(0.0f) : scene->environment.radiance);
  for (uint32_t i = 0; i < scene->light_count; i++) {
    if (scene->lights[i].type == OLX_LIGHT_SUN) suns = olx_add(suns, scene->lights[i].emission);
  }
  for (uint32_t i = 0; i < scene->material_count; i++) {
    emission = olx_max(emission, olx_max3(scene->materials[i].emission));
  }
  return olx_max(olx_max3(suns), emission);
}

static void warn_about_light(const olx_scene *scene) {
  if (olx_emitters_group_count(scene) == 0) {
    olx_log(OLX_LOG_WARNING,
            "the scene has no light: no lamp, no material that shines, no environment; the field will be black");
  }
  const float brightest = brightest_light(scene);
  if (brightest > OLX_RGB9E5_MOST) {
    olx_log(OLX_LOG_WARNING,
            "a sun, the sky or a shining material brings %g W/m2, and a field holds at most %g, so that bright light "
            "will be "
            "cut: divide all lights of the scene by a factor, and multiply the exposure by it",
            (double)brightest, (double)OLX_RGB9E5_MOST);
  }
}

olx_result olx_bake(const olx_scene *scene, const olx_bake_settings *settings, const char *path,
                    const olx_progress *progress, olx_bake_stats *stats) {
  const bool writes = settings->work.parts == 0;
  OLX_TRY(check_bake(scene, settings, writes ? path : NULL));
  if (writes) OLX_TRY(olx_scene_check_output(scene, path));
  if (writes && settings->work.folder) OLX_TRY(olx_bake_check_apart(path, settings->work.folder));
  warn_about_light(scene);
  olx_bake_settings used = without_idle_spacings(settings);
  olx_bake_run b = {.context = {.scene = scene, .settings = &used}};
  char link_folder[PATH_MAX];
  OLX_TRY(olx_bake_work_check(&used));
  OLX_TRY(olx_bake_keep_limit(scene, &used, writes ? path : used.work.folder, progress, link_folder));
  if (link_folder[0]) b.link_folder = link_folder;
  OLX_TRY(olx_bake_work_open(scene, &used, &b.store));
  const olx_result result = bake_scene(&b, path, progress);
  olx_bake_work_close(b.store, &used.work, result);
  if (stats) *stats = b.stats;
  return result;
}
