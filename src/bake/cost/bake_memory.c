// Finds how much memory a bake takes, and makes it obey a limit: with links in files and fewer threads, which change no
// byte of the field, or by refusing it.
#include "bake/cost/bake_memory.h"

#include "bake/bake_run.h"
#include "bake/bake_settings.h"
#include "bake/bake_work.h"
#include "bake/cost/available.h"
#include "core/parallel.h"
#include "core/result.h"
#include "light/light_needs.h"

#include <stdio.h>
#include <string.h>

enum {
  THREAD_BYTES = 1 << 20, // stack and allocator of a thread
  LOOSE_BYTES = 4 << 20,  // tables and what the allocator keeps
  UNIT_COPIES = 2         // of a unit's bytes, while they are written or read
};

// The numbers of bytes that decide how much memory a bake takes.
typedef struct memory_needs {
  uint64_t process, explored; // before the bake, and at most until its surfels were found
  uint64_t plan;              // selectors and cells of the volume
  uint64_t relight, relight_of_thread, unit;
  olx_light_needs light;
} memory_needs;

static uint32_t threads_of(const olx_bake_settings *s) { return s->threads ? s->threads : olx_processor_count(); }

static uint64_t plan_bytes(const olx_bake_run *b) {
  uint64_t bytes = b->volume.cells.size_bytes + b->volume.cells.probe_count * sizeof *b->volume.cells.positions;
  for (uint32_t i = 0; i < OLX_SELECT_STORED; i++) bytes += b->selectors.size_bytes[i];
  return bytes;
}

// Returns the bytes of relighting's data: the lookup of surfels, links of surfels and of volume probes, sites of
// texels, lists of them that grow, and the structure that is written.
static uint64_t relight_bytes(const olx_bake_run *b, const olx_light_needs *light) {
  const olx_bake_settings *s = b->context.settings;
  const uint64_t places = light->surfels + (uint64_t)b->volume.cells.probe_count;
  const uint64_t texels = (uint64_t)b->context.probes.light_field.count * s->radiance_size * s->radiance_size;
  const uint64_t at_a_time = places < OLX_RELIGHT_PLACES ? places : OLX_RELIGHT_PLACES;
  const uint64_t stored = light->surfels * sizeof(olx_relight_surfel) +
                          places * OLX_RELIGHT_MOST_LINKS * sizeof(olx_relight_volume_link) + texels;
  return s->relight ? light->lookup_bytes + 3 * stored + at_a_time * OLX_RELIGHT_MOST_LINKS * sizeof(olx_few_link) : 0;
}

// Returns the bytes of the store's largest unit that is not one of the light's.
static uint64_t unit_bytes(const olx_bake_run *b) {
  const olx_bake_settings *s = b->context.settings;
  const uint64_t irradiance =
      b->context.probes.irradiance.count * sizeof(uint32_t) * olx_gather_record_words(&b->gather);
  const uint64_t probe = 2 * olx_capture_bytes(s->radiance_size) + 2 * olx_surface_capture_bytes(&b->surfaces, true);
  const uint64_t plan = plan_bytes(b), most = irradiance > probe ? irradiance : probe;
  return most > plan ? most : plan;
}

static olx_result find_needs(olx_bake_run *b, memory_needs *n) {
  const olx_bake_settings *s = b->context.settings;
  const olx_scene_light_settings light = olx_bake_light_settings(b);
  const olx_probe_list *probes = &b->context.probes.light_field;
  olx_bake_describe(b);
  b->gather.quadrature = olx_quadrature_shape(s->irradiance_size);
  b->gather.traces = b->gather.traces && s->bounces > 0;
  OLX_TRY(olx_bake_make_plan(b));
  n->plan = plan_bytes(b);
  if (s->light == OLX_LIGHT_CACHE) {
    OLX_TRY(olx_light_needs_find(b->context.scene, &light, probes->positions, probes->flags, probes->count, &n->light));
    n->relight = relight_bytes(b, &n->light);
    n->relight_of_thread = s->relight ? n->light.surfels * (sizeof(olx_few_link) + 2 * sizeof(uint32_t)) : 0;
  }
  n->unit = unit_bytes(b) > n->light.unit_bytes ? unit_bytes(b) : n->light.unit_bytes;
  return OLX_OK;
}

// Returns the bytes that the bake takes with so many threads, and with links in memory or in files.
static uint64_t bytes_of(const olx_bake_run *b, const memory_needs *n, uint32_t threads, bool in_files) {
  olx_bake_settings settings = *b->context.settings;
  olx_bake_run run = *b;
  settings.threads = threads;
  run.context.settings = &settings;
  const uint64_t arrays = olx_bake_array_bytes(&run) + LOOSE_BYTES + threads * (uint64_t)THREAD_BYTES +
                          (settings.work.folder ? UNIT_COPIES * n->unit : 0);
  const uint64_t links = in_files ? threads * n->light.thread_bytes : n->light.link_bytes;
  const uint64_t relight = n->relight + threads * n->relight_of_thread;
  const uint64_t solving = n->light.work_bytes > relight ? n->light.work_bytes : relight;
  const uint64_t solved = n->process + n->plan + n->light.state_bytes + solving + links;
  const uint64_t explored = n->explored + (in_files ? 0 : n->light.link_bytes);
  return (solved > explored ? solved : explored) + arrays;
}

// Returns a limit that is surely accepted for a bake of so many bytes, in whole megabytes.
static uint64_t with_margin(uint64_t bytes) { return (bytes + bytes / 16 + 3000000) / 1000000 * 1000000; }

// Returns the greatest number of threads with which the bake fits; 0 when one thread is too many.
static uint32_t fitting_threads(const olx_bake_run *b, const memory_needs *n, uint64_t limit) {
  uint32_t threads = threads_of(b->context.settings);
  while (threads > 0 && bytes_of(b, n, threads, true) > limit) threads--;
  return threads;
}

// Finds the folder for files of links: the one that holds `path`, an output or, of a part, which has no output, a work
// folder.
static void choose_folder(const char *path, char folder[PATH_MAX]) {
  snprintf(folder, PATH_MAX, "%s", path);
  char *slash = strrchr(folder, '/');
  while (slash && !slash[1] && slash > folder) {
    *slash = 0;
    slash = strrchr(folder, '/');
  }
  if (slash) slash[slash == folder ? 1 : 0] = 0;
  else snprintf(folder, PATH_MAX, ".");
}

static olx_result obey(const olx_bake_run *b, const memory_needs *n, olx_bake_settings *settings, const char *path,
                       bool *in_files) {
  const uint64_t limit = settings->memory_limit_bytes;
  *in_files = bytes_of(b, n, threads_of(settings), false) > limit;
  if (!*in_files) return OLX_OK;
  const uint32_t threads = fitting_threads(b, n, limit);
  if (threads == 0) {
    return olx_fail(OLX_ERROR_MEMORY, "%s: a limit of %.0f MB of memory is too low: this bake needs %.0f MB at least",
                    path, (double)limit * 1e-6, (double)with_margin(bytes_of(b, n, 1, true)) * 1e-6);
  }
  settings->threads = threads;
  return OLX_OK;
}

// Runs the stages that show what a bake will take, and keeps nothing of them but the run's settings.
static olx_result survey(olx_bake_run *b, const olx_progress *progress, memory_needs *n) {
  *n = (memory_needs){.process = olx_own_memory().now};
  OLX_TRY(olx_bake_begin(b, progress));
  OLX_TRY(find_needs(b, n));
  n->explored = olx_own_memory().most;
  return OLX_OK;
}

olx_result olx_bake_keep_limit(const olx_scene *scene, olx_bake_settings *settings, const char *path,
                               const olx_progress *progress, char link_folder[PATH_MAX]) {
  const olx_bake_settings asked = *settings;
  olx_bake_run b = {.context = {.scene = scene, .settings = &asked}, .link_folder = link_folder};
  memory_needs needs;
  bool in_files = false;
  link_folder[0] = 0;
  if (!settings->memory_limit_bytes) return OLX_OK;
  choose_folder(path, link_folder);
  olx_result result = survey(&b, progress, &needs);
  if (result == OLX_OK) result = obey(&b, &needs, settings, path, &in_files);
  if (!in_files) link_folder[0] = 0;
  return olx_bake_finish(&b, result, 0.0);
}

olx_result olx_bake_measure_memory(const olx_scene *scene, const olx_bake_settings *settings, const char *path,
                                   const olx_progress *progress, olx_bake_memory *memory) {
  olx_bake_sizes sizes;
  char folder[PATH_MAX];
  *memory = (olx_bake_memory){0};
  OLX_TRY(olx_bake_work_check(settings));
  OLX_TRY(olx_bake_measure(scene, settings, path, &sizes));
  choose_folder(settings->work.parts ? settings->work.folder : path, folder);
  olx_bake_run b = {.context = {.scene = scene, .settings = settings}, .link_folder = folder};
  memory_needs needs;
  const olx_result result = survey(&b, progress, &needs);
  if (result == OLX_OK) {
    memory->most_bytes = with_margin(bytes_of(&b, &needs, threads_of(settings), false));
    memory->least_bytes = with_margin(bytes_of(&b, &needs, 1, true));
  }
  return olx_bake_finish(&b, result, 0.0);
}
