// Describes a bake by everything that its results depend on, opens its work folder, and joins a folder's units into a
// field.
#include "bake/bake_work.h"

#include "bake/bake_run.h"
#include "core/chunk_file.h"
#include "core/hooks.h"
#include "core/result.h"
#include "scene/bvh.h"

#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { UNIT_FORMAT = 5 }; // format of stored units; to be raised whenever it changes

// ---- The identity of a bake

static void put_grid(olx_byte_writer *to, const olx_grid *grid) {
  olx_bytes_put(to, &grid->origin, 1, sizeof grid->origin);
  olx_bytes_put(to, &grid->spacing, 1, sizeof grid->spacing);
  olx_bytes_put(to, grid->count, 3, sizeof *grid->count);
}

// A new setting has to be added to the manifest as well, unless results do not depend on it, like the number of
// threads, the memory limit and the work folder.
_Static_assert(sizeof(olx_bake_settings) == 248, "does a new setting change results?");

static void put_settings(olx_byte_writer *to, const olx_bake_settings *s) {
  const uint32_t numbers[] = {s->probes ? s->probe_count : 0,
                              s->select_mask,
                              s->radiance_size,
                              s->probe_light,
                              s->irradiance_size,
                              s->irradiance_form,
                              s->bounce_gather,
                              s->uncompressed,
                              s->samples,
                              s->light_samples,
                              s->bounces,
                              s->light,
                              s->reference_paths,
                              s->volume_cells,
                              s->classic,
                              s->classic_size,
                              s->classic_cube_size,
                              s->classic_sharpness,
                              s->relight,
                              s->fit,
                              s->seed};
  olx_bytes_put(to, numbers, sizeof numbers / sizeof *numbers, sizeof *numbers);
  olx_bytes_put(to, &s->noise, 1, sizeof s->noise);
  // Grids that are not used may follow the bounds of the scene, which an edit changes.
  if (!s->probes) put_grid(to, &s->grid);
  if (olx_bake_keeps_probe_light(s)) put_grid(to, &s->irradiance_grid);
  if (s->probes) olx_bytes_put(to, s->probes, s->probe_count, sizeof *s->probes);
}

// Adds the views and pinned probes that say where the viewer can be: results depend on them, but a scene's hash does
// not include them.
static void put_views(olx_byte_writer *to, const olx_scene *scene) {
  const olx_probe_rules *rules = &scene->probe_rules;
  const uint32_t flags[] = {scene->camera_count, scene->has_probe_volume, rules->has_playable, rules->pinned_count};
  olx_bytes_put(to, flags, sizeof flags / sizeof *flags, sizeof *flags);
  for (uint32_t i = 0; i < scene->camera_count; i++) {
    const olx_camera *camera = &scene->cameras[i];
    const olx_vec3 view[] = {camera->eye, camera->target, camera->up, olx_splat(camera->fov_y_degrees)};
    olx_bytes_put(to, view, 4, sizeof *view);
  }
  if (scene->has_probe_volume) olx_bytes_put(to, &scene->probes_min, 1, sizeof scene->probes_min);
  if (scene->has_probe_volume) olx_bytes_put(to, &scene->probes_max, 1, sizeof scene->probes_max);
  if (rules->has_playable) olx_bytes_put(to, &rules->playable, 1, sizeof rules->playable);
  olx_bytes_put(to, rules->pinned, rules->pinned_count, sizeof *rules->pinned);
}

static void add_hashed(olx_manifest *manifest, const char *name, olx_byte_writer *bytes) {
  olx_manifest_add_hash(manifest, name, olx_content_hash(bytes->data, bytes->size_bytes));
  olx_byte_writer_free(bytes);
}

static void add_machine(olx_manifest *manifest, const olx_scene *scene) {
  const olx_bvh_engine engine = olx_bvh_describe(scene->bvh);
  char text[160], libc[80] = "an unknown C library";
  confstr(_CS_GNU_LIBC_VERSION, libc, sizeof libc);
  snprintf(text, sizeof text, "%u", engine.version);
  olx_manifest_add(manifest, "Embree", text);
  olx_manifest_add(manifest, "instructions", engine.instructions);
  snprintf(text, sizeof text, "%s, %s", libc, __builtin_cpu_supports("fma") ? "fused" : "not fused");
  olx_manifest_add(manifest, "arithmetic", text);
}

olx_manifest olx_bake_manifest(const olx_scene *scene, const olx_bake_settings *settings) {
  olx_manifest manifest = {""};
  const olx_scene_parts_hash parts = olx_scene_hash_parts(scene);
  olx_byte_writer views = {0}, chosen = {0};
  char format[32];
  snprintf(format, sizeof format, "%d.%d", OLX_FIELD_VERSION, UNIT_FORMAT);
  put_views(&views, scene);
  put_settings(&chosen, settings);
  olx_manifest_add(&manifest, "format", format);
  olx_manifest_add(&manifest, "build", olx_name_build().text);
  add_machine(&manifest, scene);
  olx_manifest_add(&manifest, "capture", settings->raster ? settings->raster->name : "rays");
  // Parts of the scene are listed in the order of their bits in scene_parts.h.
  olx_manifest_add_hash(&manifest, "geometry", parts.geometry);
  olx_manifest_add_hash(&manifest, "materials", parts.materials);
  olx_manifest_add_hash(&manifest, "lights", parts.lights);
  add_hashed(&manifest, "views", &views);
  add_hashed(&manifest, "settings", &chosen);
  olx_manifest_add(&manifest, "parts-of-scene", "geometry materials lights views");
  olx_manifest_add(
      &manifest, "stages",
      "manifest plan scene light points cast surfels direct bounce final record lookup facts volume irradiance classic "
      "relight gathers probe awaited");
  return manifest;
}

// ---- The folder

static void report_unit(void *user, const olx_unit_done *unit) {
  const olx_bake_work *work = user;
  const olx_bake_unit done = {unit->name.stage, unit->name.round, unit->name.unit, unit->count,
                              unit->found,      unit->seconds,    unit->bytes,     unit->why};
  work->done(work->user, &done);
}

static bool wait_for_others(void *user, double waited_seconds) {
  const olx_bake_work *work = user;
  return work->wait(work->user, waited_seconds);
}

bool olx_bake_can_be_kept(const olx_bake_settings *s) {
  return !s->classic || (s->bounce_gather == OLX_GATHER_SOLVED && s->light == OLX_LIGHT_CACHE);
}

olx_result olx_bake_work_check(const olx_bake_settings *s) {
  const olx_bake_work *work = &s->work;
  if (!work->folder) {
    return work->parts ? olx_fail(OLX_ERROR_ARGUMENT, "bake: a part needs a work folder") : OLX_OK;
  }
  if (work->parts && (work->part < 1 || work->part > work->parts)) {
    return olx_fail(OLX_ERROR_ARGUMENT, "bake: part %u of %u: must be from 1 to %u", work->part, work->parts,
                    work->parts);
  }
  if (work->parts && work->fresh) return olx_fail(OLX_ERROR_ARGUMENT, "bake: a part cannot forget what others made");
  if (olx_bake_can_be_kept(s)) return OLX_OK;
  return olx_fail(OLX_ERROR_UNSUPPORTED,
                  "bake: a work folder cannot keep classic maps with bounces between irradiance probes");
}

olx_result olx_bake_check_apart(const char *path, const char *folder) {
  const char *slash = strrchr(path, '/');
  char parent[PATH_MAX] = ".";
  struct stat outputs, results;
  const size_t length = slash == path ? 1 : slash ? (size_t)(slash - path) : 0;
  if (length >= sizeof parent) return olx_fail(OLX_ERROR_FILE, "%s: the name is too long", path);
  if (length > 0) snprintf(parent, sizeof parent, "%.*s", (int)length, path);
  if (stat(folder, &results) != 0 || stat(parent, &outputs) != 0) return OLX_OK;
  if (results.st_dev != outputs.st_dev || results.st_ino != outputs.st_ino) return OLX_OK;
  return olx_fail(OLX_ERROR_ARGUMENT, "%s: lies in the work folder %s, where only results of the bake may be", path,
                  folder);
}

olx_result olx_bake_work_open(const olx_scene *scene, const olx_bake_settings *settings, olx_unit_store **store) {
  const olx_bake_work *work = &settings->work;
  *store = NULL;
  OLX_TRY(olx_bake_work_check(settings));
  if (!work->folder) return OLX_OK;
  const olx_manifest manifest = olx_bake_manifest(scene, settings);
  const olx_unit_store_settings opening = {.folder = work->folder,
                                           .manifest = &manifest,
                                           .fresh = work->fresh,
                                           .edited = work->keep && !work->parts,
                                           .limit_bytes = work->limit_bytes,
                                           .part = work->part,
                                           .parts = work->parts,
                                           .done = work->done ? report_unit : NULL,
                                           .wait = work->wait ? wait_for_others : NULL,
                                           .user = (void *)(uintptr_t)work};
  return olx_unit_store_open(&opening, store);
}

void olx_bake_work_close(olx_unit_store *store, const olx_bake_work *work, olx_result result) {
  if (result == OLX_OK && !work->parts) olx_unit_store_tidy(store);
  olx_unit_store_close(store, result == OLX_OK && !work->keep && !work->parts);
}

// ---- Joining

static olx_result check_build(const olx_unit_store *store, const char *folder) {
  const olx_manifest_value build = olx_manifest_find(olx_unit_store_manifest(store), "build");
  const olx_build_name own = olx_name_build();
  if (strcmp(build.text, own.text) == 0) return OLX_OK;
  return olx_fail(OLX_ERROR_ARGUMENT, "%s: the work folder is of another build of Octalux: %s, and this is %s", folder,
                  build.text, own.text);
}

static olx_result run_join(olx_bake_run *b, const char *path) {
  OLX_TRY(olx_bake_plan(b, NULL));
  olx_bake_describe(b);
  b->gather.quadrature = olx_quadrature_shape(b->context.settings->irradiance_size);
  b->context.task.total_units = b->context.probes.light_field.count * olx_capture_units(&b->capture);
  OLX_TRY(olx_bake_create_file(b, path));
  OLX_TRY(olx_bake_facts(b));
  OLX_TRY(olx_volume_bake_write(&b->volume, NULL, b->store, b->writer, &b->stats));
  OLX_TRY(olx_bake_irradiance(b, NULL));
  OLX_TRY(olx_bake_classic(b));
  OLX_TRY(olx_bake_relight(b));
  return olx_bake_probes(b);
}

static olx_result join(olx_bake_run *b, const char *path, const olx_progress *progress) {
  const double start = olx_seconds();
  olx_task_begin(&b->context.task, progress, "joining", 1);
  olx_scratch_pool_begin(&b->shade.pool, sizeof(olx_shade_scratch)); // scratch memory for shading, which joining never
                                                                     // does
  return olx_bake_finish(b, run_join(b, path), start);
}

olx_result olx_bake_join(const char *folder, const char *path, bool keep, const olx_progress *progress,
                         olx_bake_stats *stats) {
  const olx_unit_store_settings opening = {.folder = folder};
  olx_joined_bake joined;
  memset(&joined, 0, sizeof joined);
  olx_bake_run b = {.context = {.scene = &joined.scene, .settings = &joined.settings}, .joined = &joined};
  OLX_TRY(olx_output_check(path, false));
  OLX_TRY(olx_bake_check_apart(path, folder));
  OLX_TRY(olx_unit_store_open(&opening, &b.store));
  olx_result result = check_build(b.store, folder);
  if (result == OLX_OK) result = join(&b, path, progress);
  olx_unit_store_close(b.store, result == OLX_OK && !keep);
  if (stats) *stats = b.stats;
  return result;
}
