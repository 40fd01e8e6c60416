// Runs one bake from its settings to its file: checks the settings, places the probes, solves the light of the scene,
// captures every probe, and hands what is done to the writer, so that memory never holds the whole field.
#include <octalux/bake.h>

#include "bake/available.h"
#include "bake/bake_run.h"
#include "bake/bake_work.h"
#include "bake/buried.h"
#include "bake/gather_bounces.h"
#include "core/hooks.h"
#include "core/result.h"
#include "scene/emitters.h"
#include "scene/sources.h"

#include <assert.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>

enum {
  MAX_PROBES = 1 << 20,
  CHEAP_PROBES = 64 // irradiance probes that cost too little to save on
};

olx_bake_settings olx_bake_settings_default(const olx_scene *scene) {
  olx_bake_settings settings = {.radiance_size = 512,
                                .irradiance_size = 128,
                                .samples = 2,
                                .light_samples = 1,
                                .bounces = 32,
                                .noise = 0.02f,
                                .reference_paths = 64,
                                .volume_cells = 32,
                                .fit = true,
                                .classic_size = 128,
                                .classic_cube_size = 256};
  if (olx_scene_probe_grid(scene, NULL, &settings.grid) != OLX_OK) settings.grid = (olx_grid){0};
  settings.irradiance_grid = olx_bake_irradiance_grid(&settings.grid);
  return settings;
}

bool olx_bake_keeps_probe_light(const olx_bake_settings *s) {
  const bool volume = s->volume_cells > 0 && s->light == OLX_LIGHT_CACHE;
  return s->probe_light || s->classic || !volume || s->irradiance_form != OLX_IRRADIANCE_OCTAHEDRAL ||
         s->bounce_gather != OLX_GATHER_SOLVED;
}

const char *olx_bake_light_name(olx_bake_light light) {
  static const char *const names[] = {"cache", "reference"};
  assert(light <= OLX_LIGHT_REFERENCE);
  return names[light];
}

olx_grid olx_bake_irradiance_grid(const olx_grid *grid) {
  const float spacing[3] = {grid->spacing.x, grid->spacing.y, grid->spacing.z};
  olx_grid finer = *grid;
  float halved[3];
  uint64_t probes = 1;
  for (uint32_t axis = 0; axis < 3; axis++) {
    const bool single = grid->count[axis] < 2;
    finer.count[axis] = single ? grid->count[axis] : 2 * grid->count[axis] - 1;
    halved[axis] = single ? spacing[axis] : 0.5f * spacing[axis];
    probes *= finer.count[axis];
    if (probes > CHEAP_PROBES) return *grid;
  }
  finer.spacing = olx_v3(halved[0], halved[1], halved[2]);
  return finer;
}

static olx_result check_grid(const olx_grid *grid, const char *name) {
  uint64_t probes = 1;
  const float spacing[3] = {grid->spacing.x, grid->spacing.y, grid->spacing.z};
  for (uint32_t axis = 0; axis < 3; axis++) {
    if (grid->count[axis] == 0) return olx_fail(OLX_ERROR_ARGUMENT, "bake: %s: a count of 0 probes", name);
    probes *= grid->count[axis];
    if (probes > MAX_PROBES) return olx_fail(OLX_ERROR_ARGUMENT, "bake: %s: more than %d probes", name, MAX_PROBES);
    if (!isfinite(spacing[axis]) || spacing[axis] < 0.0f || (grid->count[axis] > 1 && spacing[axis] <= 0.0f)) {
      return olx_fail(OLX_ERROR_ARGUMENT, "bake: %s: spacing %g along axis %u", name, (double)spacing[axis], axis);
    }
  }
  const olx_vec3 last = {grid->origin.x + spacing[0] * (float)(grid->count[0] - 1),
                         grid->origin.y + spacing[1] * (float)(grid->count[1] - 1),
                         grid->origin.z + spacing[2] * (float)(grid->count[2] - 1)};
  if (!olx_is_position(grid->origin) || !olx_is_position(last)) {
    return olx_fail(OLX_ERROR_ARGUMENT, "bake: %s: its probes are not within 2e7 m", name);
  }
  return OLX_OK;
}

static olx_result check_size(uint32_t size, uint32_t least, uint32_t most, const char *name) {
  if (size >= least && size <= most && (size & (size - 1)) == 0) return OLX_OK;
  return olx_fail(OLX_ERROR_ARGUMENT, "bake: %s of %u texels: must be a power of two from %u to %u", name, size, least,
                  most);
}

static olx_result check_range(uint32_t value, uint32_t least, uint32_t most, const char *name) {
  if (value >= least && value <= most) return OLX_OK;
  return olx_fail(OLX_ERROR_ARGUMENT, "bake: %s %u: must be from %u to %u", name, value, least, most);
}

static olx_result check_probes(const olx_bake_settings *settings) {
  if (!settings->probes) return check_grid(&settings->grid, "probe grid");
  OLX_TRY(check_range(settings->probe_count, 1, MAX_PROBES, "probes"));
  for (uint32_t i = 0; i < settings->probe_count; i++) {
    if (!olx_is_position(settings->probes[i])) {
      return olx_fail(OLX_ERROR_ARGUMENT, "bake: the position of probe %u is not within 2e7 m", i);
    }
  }
  return OLX_OK;
}

static olx_result check_select(const olx_bake_settings *settings) {
  const uint32_t mask = settings->select_mask;
  if (mask & ~olx_selectors_known()) return olx_fail(OLX_ERROR_ARGUMENT, "bake: unknown selectors (mask %#x)", mask);
  if (settings->probes && (mask & 1u << OLX_SELECT_CAGE)) {
    return olx_fail(OLX_ERROR_ARGUMENT, "bake: the selector 'cage' needs probes on a grid");
  }
  return OLX_OK;
}

static olx_result check_classic(const olx_bake_settings *settings) {
  if (!settings->classic) return OLX_OK;
  OLX_TRY(check_size(settings->classic_size, 32, 256, "classic size"));
  OLX_TRY(check_size(settings->classic_cube_size, 32, 1024, "cube size"));
  return settings->classic_sharpness ? check_range(settings->classic_sharpness, 64, 65536, "sharpness") : OLX_OK;
}

static olx_result check_relight(const olx_bake_settings *settings) {
  if (!settings->relight || settings->light == OLX_LIGHT_CACHE) return OLX_OK;
  return olx_fail(OLX_ERROR_ARGUMENT, "bake: relighting needs the light of the scene, not the reference");
}

static olx_result check_probe_light(const olx_bake_settings *settings) {
  OLX_TRY(check_grid(&settings->irradiance_grid, "irradiance grid"));
  OLX_TRY(check_size(settings->irradiance_size, 8, 256, "irradiance size"));
  OLX_TRY(check_range(settings->irradiance_form, OLX_IRRADIANCE_OCTAHEDRAL, OLX_IRRADIANCE_SH3, "form of irradiance"));
  return check_range(settings->bounce_gather, OLX_GATHER_SOLVED, OLX_GATHER_TRACED, "way to gather bounces");
}

static olx_result check_settings(const olx_bake_settings *settings) {
  OLX_TRY(check_probes(settings));
  OLX_TRY(check_select(settings));
  OLX_TRY(check_size(settings->radiance_size, 8, 2048, "radiance size"));
  if (olx_bake_keeps_probe_light(settings)) OLX_TRY(check_probe_light(settings));
  OLX_TRY(check_relight(settings));
  OLX_TRY(check_classic(settings));
  OLX_TRY(check_range(settings->light, OLX_LIGHT_CACHE, OLX_LIGHT_REFERENCE, "kind of light"));
  if (!(settings->noise >= 0.001f && settings->noise <= 1.0f))
    return olx_fail(OLX_ERROR_ARGUMENT, "bake: noise must be 0.001 to 1, not %g", (double)settings->noise);
  OLX_TRY(check_range(settings->reference_paths, 1, 65536, "reference paths"));
  OLX_TRY(check_range(settings->volume_cells, 0, 256, "cells of the volume"));
  OLX_TRY(check_range(settings->samples, 1, 8, "samples"));
  OLX_TRY(check_range(settings->light_samples, 1, 64, "light samples"));
  return check_range(settings->bounces, 0, 64, "bounces");
}

// Probes at `positions`, or on the grid where that is NULL.
static olx_result place_probes(olx_bake_run *b, uint32_t set, const olx_grid *grid, const olx_vec3 *positions,
                               uint32_t position_count) {
  const uint32_t count = positions ? position_count : grid->count[0] * grid->count[1] * grid->count[2];
  b->counts[set] = count;
  b->positions[set] = olx_allocate(count, sizeof(olx_vec3));
  b->flags[set] = olx_allocate_zero(count, 1);
  if (!b->positions[set] || !b->flags[set])
    return olx_fail(OLX_ERROR_MEMORY, "bake: out of memory for %u probes", count);
  for (uint32_t i = 0; i < count; i++) {
    b->positions[set][i] = positions ? positions[i] : olx_grid_position(grid, i);
  }
  return OLX_OK;
}

// Spacing along an axis with one probe means nothing; a field says 0.
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

// Bricks are in every field that they can be in: surfaces that light is stored on are found by them.
static uint32_t select_mask(const olx_bake_settings *settings) {
  const uint32_t *count = settings->grid.count;
  const uint64_t probes = settings->probes ? settings->probe_count : (uint64_t)count[0] * count[1] * count[2];
  const uint32_t bricks = probes <= OLX_BRICK_MOST_PROBES ? 1u << OLX_SELECT_BRICKS : 0;
  if (settings->select_mask) return settings->select_mask | bricks;
  return settings->probes ? bricks : 1u << OLX_SELECT_CAGE | bricks;
}

// What the field will be: for the file, and to know its size before anything is made.
static olx_field_header header_of(const olx_bake_run *b) {
  const olx_bake_settings *s = b->settings;
  olx_field_header header = {
      .info = {.probe_count = b->counts[0],
               .irradiance_probe_count = b->counts[1],
               .has_grid = !s->probes,
               .grid = s->grid,
               .radiance_size = s->radiance_size,
               .select_mask = select_mask(s),
               .distance_scale_metres = b->distance_scale,
               .scene_min = b->scene->bounds_min,
               .scene_max = b->scene->bounds_max,
               .bounces = s->bounces,
               .samples = s->samples,
               .scene_hash = b->scene->hash,
               .compressed = !s->uncompressed,
               .geometry_blocks = !s->uncompressed},
      .origin = {b->scene->origin[0], b->scene->origin[1], b->scene->origin[2]},
      .probe_positions = b->positions[0],
      .irradiance_positions = b->positions[1],
      .lights = b->lights,
      .light_count = b->scene->light_count,
      .classic_table = b->classic_table,
      .volume = b->volume.cells.data,
      .volume_bytes = b->volume.cells.size_bytes,
      .volume_positions = b->volume.cells.positions,
  };
  header.info.volume_probe_count = b->volume.cells.probe_count;
  if (b->counts[1]) {
    header.info.irradiance_grid = s->irradiance_grid;
    header.info.irradiance_size = s->irradiance_size;
    header.info.irradiance_form = s->irradiance_form;
  }
  if (s->classic) {
    header.info.classic_size = s->classic_size;
    header.info.classic_cube_size = s->classic_cube_size;
    header.info.classic_sharpness = (float)b->classic.filter.sharpness;
  }
  header.relight = s->relight;
  for (olx_select select = OLX_SELECT_CAGE; select < OLX_SELECT_STORED; select++) {
    header.select_data[select] = b->selectors.data[select];
    header.select_bytes[select] = b->selectors.size_bytes[select];
  }
  return header;
}

olx_result olx_bake_create_file(olx_bake_run *b, const char *path) {
  const olx_field_header header = header_of(b);
  return olx_field_writer_create(path, &header, &b->writer);
}

static olx_result find_buried(olx_bake_run *b) {
  const olx_vec3 *positions[2] = {b->positions[0], b->positions[1]};
  uint64_t rays = 0;
  OLX_TRY(olx_find_buried(b->scene, positions, b->counts, b->flags, b->settings->threads, &rays));
  b->stats.rays += rays;
  for (uint32_t i = 0; i < b->counts[0]; i++) b->stats.buried += b->flags[0][i] & OLX_PROBE_BURIED;
  for (uint32_t i = 0; i < b->counts[1]; i++) b->stats.irradiance_buried += b->flags[1][i] & OLX_PROBE_BURIED;
  return OLX_OK;
}

static olx_result build_selectors(olx_bake_run *b) {
  const olx_bake_settings *s = b->settings;
  const uint64_t side = s->radiance_size + 2;
  const olx_selector_input input = {.scene = b->scene,
                                    .positions = b->positions[0],
                                    .flags = b->flags[0],
                                    .count = b->counts[0],
                                    .radiance_size = s->radiance_size,
                                    .map_bytes = b->counts[0] * side * side * OLX_LIGHT_FIELD_TEXEL_BYTES,
                                    .distance_scale = b->distance_scale,
                                    .threads = s->threads,
                                    .task = &b->task};
  olx_task_stage(&b->task, "selectors");
  return olx_selectors_build(&input, select_mask(s), &b->selectors);
}

static olx_result gather_solved(olx_bake_run *b) {
  OLX_TRY(olx_gather_look(&b->gather));
  OLX_TRY(olx_gather_solved(&b->gather));
  OLX_TRY(olx_gather_irradiance(&b->gather, 0));
  return b->settings->fit ? olx_gather_fit(&b->gather, 0) : OLX_OK;
}

// All bounces that are asked for, as long as they bring light.
static olx_result gather_bounces(olx_bake_run *b) {
  OLX_TRY(olx_gather_look(&b->gather));
  OLX_TRY(olx_gather_link(&b->gather));
  for (uint32_t bounce = 0; bounce <= b->settings->bounces; bounce++) {
    if (bounce > 0) OLX_TRY(olx_gather_bounce(&b->gather, bounce));
    OLX_TRY(olx_gather_irradiance(&b->gather, bounce));
    if (b->settings->fit) OLX_TRY(olx_gather_fit(&b->gather, bounce));
    b->bounces = bounce;
    if (bounce > 0 && !olx_gather_brought_light(&b->gather, bounce)) break;
  }
  olx_gather_skip(&b->gather, b->settings->bounces - b->bounces);
  if (b->gather.traces) {
    b->stats.unseen =
        (double)atomic_load(&b->gather.traced.unseen) / fmax(1.0, (double)atomic_load(&b->gather.traced.rays));
  }
  return OLX_OK;
}

static olx_result gather_light(olx_bake_run *b) {
  const olx_bake_settings *s = b->settings;
  const double start = olx_seconds();
  OLX_TRY(olx_gather_create(&b->gather, &s->irradiance_grid, s->irradiance_size, s->bounces));
  OLX_TRY(b->gather.light ? gather_solved(b) : gather_bounces(b));
  b->stats.irradiance_seconds = olx_seconds() - start;
  return OLX_OK;
}

static void describe_classic(olx_bake_run *b) {
  const olx_bake_settings *s = b->settings;
  const uint32_t sharpness =
      s->classic_sharpness ? s->classic_sharpness : olx_classic_sharpness(s->classic_size, s->classic_cube_size);
  b->classic = (olx_classic_bake){
      .shade = &b->shade,
      .filter = {.size = s->classic_size,
                 .cube_size = s->classic_cube_size,
                 .sharpness = sharpness,
                 .threads = s->threads},
      .light_samples = s->light_samples,
      .task = &b->task,
  };
}

static olx_result make_classic_table(olx_bake_run *b) {
  if (!b->settings->classic) return OLX_OK;
  b->classic_table = olx_allocate(OLX_CLASSIC_TABLE_ENTRIES, sizeof *b->classic_table);
  if (!b->classic_table) return olx_fail(OLX_ERROR_MEMORY, "bake: out of memory for a table of reflectances");
  return olx_classic_table_make(b->classic_table, b->settings->threads);
}

static olx_result solve_light(olx_bake_run *b) {
  const olx_bake_settings *s = b->settings;
  if (s->light == OLX_LIGHT_REFERENCE) return OLX_OK;
  olx_task_stage(&b->task, "light");
  olx_scene_light_settings settings = olx_scene_light_settings_default();
  settings.bounces = s->bounces + 1;
  settings.noise = s->noise;
  settings.map_size = s->radiance_size;
  settings.seed = b->shade.seed;
  settings.threads = s->threads;
  settings.task = &b->task;
  settings.store = b->store;
  OLX_TRY(olx_scene_light_create(b->scene, &settings, b->positions[0], b->flags[0], b->counts[0], &b->light));
  const olx_scene_light_report report = olx_scene_light_describe(b->light);
  b->stats.rays += report.rays;
  b->stats.surfels = report.surfels;
  b->stats.noise = report.noise;
  b->stats.light_bytes = report.bytes;
  b->stats.light_seconds = report.seconds;
  return OLX_OK;
}

static olx_result make_volume_cells(olx_bake_run *b) {
  b->volume = (olx_volume_bake){.scene = b->scene,
                                .settings = b->settings,
                                .positions = b->positions[0],
                                .flags = b->flags[0],
                                .probe_count = b->counts[0],
                                .seed = b->shade.seed,
                                .task = &b->task};
  return olx_volume_bake_create(&b->volume, &b->stats);
}

// Whether irradiance probes, too, get their light from the solution for the whole scene.
static bool is_solved(const olx_bake_settings *s) {
  return s->light == OLX_LIGHT_CACHE && s->bounce_gather == OLX_GATHER_SOLVED;
}

void olx_bake_describe(olx_bake_run *b) {
  const olx_bake_settings *s = b->settings;
  b->gather = (olx_gather){.shade = &b->shade,
                           .positions = b->positions[1],
                           .flags = b->flags[1],
                           .probe_count = b->counts[1],
                           .light_samples = s->light_samples,
                           .threads = s->threads,
                           .distance_scale = b->distance_scale,
                           .task = &b->task,
                           .form = s->irradiance_form,
                           .traces = s->bounce_gather == OLX_GATHER_TRACED};
  b->capture = (olx_capture){.scene = b->scene,
                             .size = s->radiance_size,
                             .samples = s->samples,
                             .light_samples = s->light_samples,
                             .bounces = s->bounces,
                             .threads = s->threads,
                             .distance_scale = b->distance_scale,
                             .task = &b->task};
  b->surfaces = (olx_surface_capture){.capture = &b->capture,
                                      .seed = s->seed,
                                      .reference_paths = s->reference_paths,
                                      .has_radiance = b->counts[1] > 0,
                                      .compressed = !s->uncompressed};
  if (s->classic) describe_classic(b);
}

// Units of progress, in rays; the quadrature of the gather must be known.
static uint64_t units_of(const olx_bake_run *b) {
  const olx_bake_settings *s = b->settings;
  uint64_t units = olx_gather_units(&b->gather, s->bounces, is_solved(s)) +
                   b->counts[0] * olx_capture_units(&b->capture);
  if (s->fit) units += olx_surface_fit_units(b->counts[1], is_solved(s));
  if (s->classic) units += b->counts[1] * olx_classic_bake_units(&b->classic);
  return units;
}

static olx_result make_plan(olx_bake_run *b) {
  OLX_TRY(olx_surface_lights(b->scene, &b->lights));
  OLX_TRY(find_buried(b));
  OLX_TRY(build_selectors(b));
  OLX_TRY(make_classic_table(b));
  return make_volume_cells(b);
}

// A part goes on to what does not need what is missing.
static olx_result go_on(olx_bake_run *b, olx_result result) {
  if (result != OLX_ERROR_INCOMPLETE || !olx_unit_store_is_part(b->store)) return result;
  b->incomplete = true;
  return OLX_OK;
}

// All that is read from the solved light.
static olx_result run_probes(olx_bake_run *b) {
  OLX_TRY(go_on(b, olx_bake_facts(b)));
  OLX_TRY(go_on(b, olx_volume_bake_write(&b->volume, b->light, b->store, b->writer, &b->stats)));
  OLX_TRY(go_on(b, olx_bake_irradiance(b, gather_light)));
  OLX_TRY(go_on(b, olx_bake_classic(b)));
  OLX_TRY(go_on(b, olx_bake_relight(b)));
  OLX_TRY(go_on(b, olx_bake_probes(b)));
  return b->incomplete ? OLX_ERROR_INCOMPLETE : OLX_OK;
}

// Everything but committing the file. What was made is released by olx_bake_finish.
static olx_result run(olx_bake_run *b, const char *path) {
  const olx_bake_settings *s = b->settings;
  olx_bake_describe(b);
  OLX_TRY(olx_bake_plan(b, make_plan));
  const bool is_part = olx_unit_store_is_part(b->store);
  if (is_part && olx_bake_is_stored(b)) return OLX_OK;
  if (!is_part) OLX_TRY(olx_bake_create_file(b, path));
  OLX_TRY(olx_capture_create(&b->capture));
  if (s->classic) OLX_TRY(olx_classic_bake_create(&b->classic));
  OLX_TRY(solve_light(b));
  if (is_solved(s)) b->gather.light = b->shade.light = b->light;
  b->surfaces.light = b->light;
  b->bounces = s->bounces;
  OLX_TRY(olx_surface_capture_create(&b->surfaces));
  b->stats.primary_rays = b->counts[0] * olx_capture_units(&b->capture);
  b->gather.quadrature = olx_quadrature_shape(s->irradiance_size);
  b->task.total_units = units_of(b);
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
  olx_task_end(&b->task);
  struct rusage usage;
  for (uint32_t set = 0; set < 2; set++) {
    olx_release(b->positions[set]);
    olx_release(b->flags[set]);
  }
  getrusage(RUSAGE_SELF, &usage);
  b->stats.peak_memory_bytes = (uint64_t)usage.ru_maxrss * 1024u;
  b->stats.seconds = olx_seconds() - start - b->stats.write_seconds - b->measure_seconds;
  return result;
}

static olx_result bake_scene(olx_bake_run *b, const char *path, const olx_progress *progress) {
  const double start = olx_seconds();
  OLX_TRY(place_probes(b, 0, &b->settings->grid, b->settings->probes, b->settings->probe_count));
  if (olx_bake_keeps_probe_light(b->settings)) OLX_TRY(place_probes(b, 1, &b->settings->irradiance_grid, NULL, 0));
  b->distance_scale = olx_length(olx_sub(b->scene->bounds_max, b->scene->bounds_min));
  olx_task_begin(&b->task, progress, "probes", 1);
  olx_shade_context_begin(&b->shade, b->scene, b->settings->seed);
  const float spacing = least_spacing(&b->settings->irradiance_grid, b->distance_scale);
  b->shade.share_distance = 0.01f * spacing;
  return olx_bake_finish(b, run(b, path), start);
}

static uint64_t grid_count(const olx_grid *grid) { return (uint64_t)grid->count[0] * grid->count[1] * grid->count[2]; }

// What run would hold at once, of a bake that is described and not begun.
static uint64_t memory_of(const olx_bake_run *b, const olx_field_layout *layout) {
  const olx_bake_settings *s = b->settings;
  const uint32_t threads = s->threads ? s->threads : olx_processor_count();
  const uint64_t probe_bytes = 2 * (sizeof(olx_vec3) + 1); // here and in the writer
  uint64_t bytes = ((uint64_t)b->counts[0] + b->counts[1]) * probe_bytes + threads * sizeof(olx_shade_scratch);
  if (b->counts[1]) bytes += olx_gather_bytes(&b->gather, s->irradiance_size, s->bounces, is_solved(s), s->fit);
  bytes += olx_capture_bytes(s->radiance_size);
  bytes += layout->shapes[OLX_CHUNK_RADIANCE].record_bytes + layout->shapes[OLX_CHUNK_LEAST].record_bytes +
           layout->shapes[OLX_CHUNK_GREATEST].record_bytes; // the writer's map and pyramid
  bytes += olx_surface_capture_bytes(&b->surfaces, s->light == OLX_LIGHT_CACHE);
  return s->classic ? bytes + olx_classic_bake_bytes(&b->classic) : bytes;
}

// Maps are stored without borders, but emission, which the layout leaves out, and distances without their pyramid are whole; of light the
// links are bounded, and steps that are stored several times are far smaller.
static uint64_t work_of(const olx_bake_run *b, const olx_field_layout *layout) {
  const uint64_t light = b->settings->light == OLX_LIGHT_CACHE ? UINT64_C(2) << 30 : 0,
                 size = b->settings->radiance_size;
  return layout->file_bytes + b->counts[0] * size * size * sizeof(uint32_t) + light;
}

// "12 light field and 27 irradiance probes"
typedef struct probes_text {
  char text[80];
} probes_text;

static probes_text name_probes(const olx_bake_sizes *sizes) {
  probes_text name;
  const unsigned long long light = sizes->probes, irradiance = sizes->irradiance_probes;
  if (irradiance)
    snprintf(name.text, sizeof name.text, "%llu light field and %llu irradiance probes", light, irradiance);
  else snprintf(name.text, sizeof name.text, "%llu light field probes", light);
  return name;
}

static olx_result check_available(const olx_bake_sizes *sizes, const char *path) {
  const double gibibyte = 0x1p30;
  const probes_text probes = name_probes(sizes);
  if (sizes->file_bytes > sizes->available_disk_bytes) {
    return olx_fail(
        OLX_ERROR_FILE,
        "%s: %s make a file of %.2f GiB (%llu bytes), and %.2f GiB are free there: fewer probes, or smaller "
        "maps (radiance_size, irradiance_size)",
        path, probes.text, (double)sizes->file_bytes / gibibyte, (unsigned long long)sizes->file_bytes,
        (double)sizes->available_disk_bytes / gibibyte);
  }
  if (sizes->memory_bytes <= sizes->available_memory_bytes) return OLX_OK;
  return olx_fail(OLX_ERROR_MEMORY,
                  "%s: baking %s takes %.2f GiB of memory (%llu bytes), and %.2f GiB are available: fewer of them, or "
                  "smaller maps (radiance_size, irradiance_size)",
                  path, probes.text, (double)sizes->memory_bytes / gibibyte, (unsigned long long)sizes->memory_bytes,
                  (double)sizes->available_memory_bytes / gibibyte);
}

olx_result olx_bake_measure(const olx_scene *scene, const olx_bake_settings *settings, const char *path,
                            olx_bake_sizes *sizes) {
  *sizes = (olx_bake_sizes){0};
  OLX_TRY(check_settings(settings));
  if (scene->triangle_count == 0) return olx_fail(OLX_ERROR_EMPTY, "%s: the scene has no triangles", path);
  olx_bake_run b = {.scene = scene, .settings = settings, .distance_scale = 1.0f};
  b.counts[0] = settings->probes ? settings->probe_count : (uint32_t)grid_count(&settings->grid);
  if (olx_bake_keeps_probe_light(settings)) b.counts[1] = (uint32_t)grid_count(&settings->irradiance_grid);
  olx_bake_describe(&b);
  b.gather.quadrature = olx_quadrature_shape(settings->irradiance_size);
  b.gather.traces = b.gather.traces && settings->bounces > 0;
  const olx_field_header header = header_of(&b);
  olx_field_layout layout;
  olx_field_lay_out(&header, &layout);
  *sizes = (olx_bake_sizes){.probes = b.counts[0],
                            .irradiance_probes = b.counts[1],
                            .file_bytes = layout.file_bytes,
                            .device_bytes = layout.device_bytes,
                            .memory_bytes = memory_of(&b, &layout),
                            .work_bytes = work_of(&b, &layout),
                            .rays = units_of(&b),
                            .available_memory_bytes = olx_available_memory(),
                            .available_disk_bytes = olx_available_disk(path)};
  return check_available(sizes, path);
}

olx_result olx_bake(const olx_scene *scene, const olx_bake_settings *settings, const char *path,
                    const olx_progress *progress, olx_bake_stats *stats) {
  olx_bake_sizes sizes;
  const bool writes = settings->work.parts == 0;
  OLX_TRY(olx_bake_measure(scene, settings, writes ? path : "", &sizes));
  if (writes) OLX_TRY(olx_output_check(path, false));
  if (writes) OLX_TRY(olx_scene_check_output(scene, path));
  if (olx_emitters_group_count(scene) == 0) {
    olx_log(OLX_LOG_WARNING,
            "the scene has no light: no lamp, no material that shines, no environment; the field will be black");
  }
  olx_bake_settings used = *settings;
  used.grid = without_idle_spacing(settings->grid);
  used.irradiance_grid = without_idle_spacing(settings->irradiance_grid);
  olx_bake_run b = {.scene = scene, .settings = &used};
  OLX_TRY(olx_bake_work_open(scene, &used, &b.store));
  const olx_result result = bake_scene(&b, path, progress);
  olx_bake_work_close(b.store, &used.work, result);
  if (stats) *stats = b.stats;
  return result;
}
