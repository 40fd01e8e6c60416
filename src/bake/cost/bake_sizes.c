// Computes the size of a bake's files and memory before it begins, from the code that lays out and allocates them, and
// refuses a bake that does not fit the machine.
#include "bake/bake_run.h"
#include "bake/bake_settings.h"
#include "bake/bake_work.h"
#include "bake/cost/available.h"
#include "core/parallel.h"
#include "core/result.h"
#include "place/cost/field_bytes.h"

#include <octalux/limits.h>

#include <math.h>
#include <stdio.h>

enum { VOLUME_MOST_BYTES = 8 << 20, BRICKS_MOST_BYTES = 4 << 20 };

static uint64_t grid_count(const olx_grid *grid) { return (uint64_t)grid->count[0] * grid->count[1] * grid->count[2]; }

// Returns the peak memory of a bake that is described and has not begun, in bytes.
static uint64_t memory_of(const olx_bake_run *b, const olx_field_layout *layout) {
  const olx_bake_settings *s = b->context.settings;
  const uint32_t threads = s->threads ? s->threads : olx_processor_count();
  const uint64_t probe_bytes = 2 * (sizeof(olx_vec3) + 1); // once here and once in the writer
  uint64_t bytes = ((uint64_t)b->context.probes.light_field.count + b->context.probes.irradiance.count) * probe_bytes +
                   threads * sizeof(olx_shade_scratch);
  if (b->context.probes.irradiance.count)
    bytes += olx_gather_bytes(&b->gather, s->irradiance_size, s->bounces, olx_bake_is_solved(s), s->fit);
  bytes += olx_capture_bytes(s->radiance_size) + olx_cube_views_bytes(s, s->radiance_size);
  bytes += layout->shapes[OLX_CHUNK_RADIANCE].record_bytes + layout->shapes[OLX_CHUNK_LEAST].record_bytes +
           layout->shapes[OLX_CHUNK_GREATEST].record_bytes; // the writer's map and pyramid
  bytes += olx_surface_capture_bytes(&b->surfaces, s->light == OLX_LIGHT_CACHE);
  return s->classic ? bytes + olx_classic_bake_bytes(&b->classic) : bytes;
}

uint64_t olx_bake_array_bytes(const olx_bake_run *b) {
  const olx_field_header header = olx_bake_header(b);
  olx_field_layout layout;
  olx_field_lay_out(&header, &layout);
  return memory_of(b, &layout);
}

static uint64_t links_of(const olx_bake_settings *settings) {
  return settings->light == OLX_LIGHT_CACHE ? olx_scene_light_most_link_bytes() : 0;
}

// Returns an upper bound of a work folder's size: the size of the file, with emission of every texel where the file
// stores it only for some tiles, and every tile of surfaces at full resolution. Links are stored once; surfels and the
// repeated checkpoints of light take less than the difference.
static uint64_t work_of(const olx_bake_run *b, const olx_field_layout *layout) {
  if (!olx_bake_can_be_kept(b->context.settings)) return 0;
  const uint64_t size = b->context.settings->radiance_size;
  const uint64_t texels = b->context.probes.light_field.count * size * size,
                 surfaces = b->context.settings->uncompressed ? 0 : olx_surface_most_bytes(texels);
  return layout->file_bytes + texels * sizeof(uint32_t) + surfaces + 2 * links_of(b->context.settings);
}

// The expected bytes of a bake's file, and of parts of it.
typedef struct expected_bytes {
  uint64_t file, surfaces; // surfaces: blocks of tiles
  uint64_t spooled;        // what the writer keeps in temporary files until the end
} expected_bytes;

static olx_result expected_of(const olx_bake_run *b, const olx_field_header *header, expected_bytes *bytes) {
  const olx_bake_settings *s = b->context.settings;
  const olx_planned_maps maps = {.scene = b->context.scene,
                                 .positions = s->probes,
                                 .grid = &s->grid,
                                 .count = b->context.probes.light_field.count,
                                 .size = s->radiance_size,
                                 .samples = s->samples,
                                 .light_samples = s->light_samples,
                                 .seed = s->seed,
                                 .bounces = s->bounces};
  const uint32_t most_cells = olx_volume_is_baked(s) ? s->volume_cells : 0;
  olx_texel_bytes texels;
  OLX_TRY(olx_texel_bytes_sample(&maps, s->threads, &texels));
  const double all = (double)maps.count * maps.size * maps.size;
  bytes->file =
      olx_expected_bytes(header, olx_expected_volume_bytes(b->context.scene, s->radiance_size, most_cells), &texels);
  bytes->surfaces = s->uncompressed ? 0 : (uint64_t)(texels.surfaces * all);
  bytes->spooled = s->uncompressed ? 0 : (uint64_t)((texels.surfaces + texels.planes) * all);
  return OLX_OK;
}

// A text that names numbers of probes, such as "12 light field and 27 irradiance probes".
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

// Refuses a bake whose file takes more than the disk has.
static olx_result check_disk(const olx_bake_sizes *sizes, uint64_t bytes, const char *path) {
  const double gibibyte = 0x1p30;
  const probes_text probes = name_probes(sizes);
  if (bytes <= sizes->available_disk_bytes) return OLX_OK;
  return olx_fail(OLX_ERROR_FILE,
                  "%s: %s make a file of %.2f GiB (%llu bytes), and %.2f GiB are free there: fewer probes, or smaller "
                  "maps (radiance_size, irradiance_size)",
                  path, probes.text, (double)bytes / gibibyte, (unsigned long long)bytes,
                  (double)sizes->available_disk_bytes / gibibyte);
}

static olx_result check_available(const olx_bake_sizes *sizes, const char *path) {
  const double gibibyte = 0x1p30;
  const probes_text probes = name_probes(sizes);
  OLX_TRY(check_disk(sizes, sizes->file_bytes, path));
  if (sizes->memory_bytes <= sizes->available_memory_bytes) return OLX_OK;
  return olx_fail(OLX_ERROR_MEMORY,
                  "%s: baking %s takes %.2f GiB of memory (%llu bytes), and %.2f GiB are available: fewer of them, or "
                  "smaller maps (radiance_size, irradiance_size)",
                  path, probes.text, (double)sizes->memory_bytes / gibibyte, (unsigned long long)sizes->memory_bytes,
                  (double)sizes->available_memory_bytes / gibibyte);
}

// Checks the settings and describes a bake that does not begin.
static olx_result describe(const olx_scene *scene, const olx_bake_settings *settings, const char *path, olx_bake_run *b,
                           olx_field_header *header) {
  OLX_TRY(olx_bake_check_settings(settings));
  if (scene->triangle_count == 0) return olx_fail(OLX_ERROR_EMPTY, "%s: the scene has no triangles", path);
  *b = (olx_bake_run){.context = {.scene = scene, .settings = settings, .distance_scale = 1.0f}};
  b->context.probes.light_field.count =
      settings->probes ? settings->probe_count : (uint32_t)grid_count(&settings->grid);
  if (olx_bake_keeps_probe_light(settings))
    b->context.probes.irradiance.count = (uint32_t)grid_count(&settings->irradiance_grid);
  olx_bake_describe(b);
  b->gather.quadrature = olx_quadrature_shape(settings->irradiance_size);
  b->gather.traces = b->gather.traces && settings->bounces > 0;
  *header = olx_bake_header(b);
  return OLX_OK;
}

static olx_bake_sizes sizes_of(const olx_bake_run *b, const olx_field_header *header, const char *path) {
  olx_field_layout layout;
  olx_field_lay_out(header, &layout);
  return (olx_bake_sizes){.probes = b->context.probes.light_field.count,
                          .irradiance_probes = b->context.probes.irradiance.count,
                          .file_bytes = layout.file_bytes,
                          .device_bytes = layout.device_bytes,
                          .memory_bytes = memory_of(b, &layout),
                          .link_bytes = links_of(b->context.settings),
                          .work_bytes = work_of(b, &layout),
                          .rays = olx_bake_units(b),
                          .available_memory_bytes = olx_available_memory(),
                          .available_disk_bytes =
                              b->context.settings->work.parts ? UINT64_MAX : olx_available_disk(path)};
}

olx_result olx_bake_measure(const olx_scene *scene, const olx_bake_settings *settings, const char *path,
                            olx_bake_sizes *sizes) {
  olx_bake_run b;
  olx_field_header header;
  *sizes = (olx_bake_sizes){0};
  OLX_TRY(describe(scene, settings, path, &b, &header));
  expected_bytes expected;
  OLX_TRY(expected_of(&b, &header, &expected));
  *sizes = sizes_of(&b, &header, path);
  sizes->expected_bytes = expected.file;
  if (sizes->device_bytes) sizes->device_bytes += expected.surfaces;
  OLX_TRY(check_available(sizes, path));
  return check_disk(sizes, expected.file + expected.spooled, path);
}

// Returns whether a disk has room for whatever the scene may add to the file's least size, with what the writer keeps
// in temporary files.
static bool has_room(const olx_bake_run *b, const olx_bake_sizes *sizes) {
  const uint64_t size = b->context.settings->radiance_size, texels = sizes->probes * size * size,
                 a_texel = sizeof(uint32_t) + 2 * sizeof(olx_plane_code);
  const uint64_t beside = VOLUME_MOST_BYTES + BRICKS_MOST_BYTES;
  return sizes->file_bytes + a_texel * texels + 2 * olx_surface_most_bytes(texels) + beside <=
         sizes->available_disk_bytes;
}

olx_result olx_bake_check_machine(const olx_scene *scene, const olx_bake_settings *settings, const char *path) {
  olx_bake_run b;
  olx_field_header header;
  OLX_TRY(describe(scene, settings, path, &b, &header));
  const olx_bake_sizes sizes = sizes_of(&b, &header, path);
  OLX_TRY(check_available(&sizes, path));
  if (has_room(&b, &sizes)) return OLX_OK;
  expected_bytes expected;
  OLX_TRY(expected_of(&b, &header, &expected));
  return check_disk(&sizes, expected.file + expected.spooled, path);
}

// Computes the expected size of the field with maps of another size, or only its least size where that is beyond the
// budget already.
static olx_result size_with_maps(const olx_scene *scene, const olx_bake_settings *settings, uint32_t radiance_size,
                                 double budget, uint64_t *bytes) {
  olx_bake_settings resized = *settings;
  resized.radiance_size = radiance_size;
  olx_bake_run b;
  olx_field_header header;
  OLX_TRY(describe(scene, &resized, "bake", &b, &header));
  olx_field_layout layout;
  olx_field_lay_out(&header, &layout);
  *bytes = layout.file_bytes;
  const bool smallest = radiance_size == OLX_RADIANCE_SIZE_LEAST;
  if ((double)*bytes > budget && !smallest) return OLX_OK;
  expected_bytes expected;
  OLX_TRY(expected_of(&b, &header, &expected));
  *bytes = expected.file;
  return OLX_OK;
}

static olx_result refuse_budget(const olx_bake_settings *settings, double budget_mb, uint64_t bytes) {
  const unsigned long long probes = settings->probes ? settings->probe_count : grid_count(&settings->grid);
  return olx_fail(OLX_ERROR_ARGUMENT,
                  "bake: a budget of %g MB does not hold a field of %llu probes: with the smallest maps, of %d x %d "
                  "texels, it takes %.3f MB; fewer probes take less",
                  budget_mb, probes, OLX_RADIANCE_SIZE_LEAST, OLX_RADIANCE_SIZE_LEAST,
                  ceil((double)bytes * 1e-3) * 1e-3);
}

olx_result olx_bake_size_for_budget(const olx_scene *scene, const olx_bake_settings *settings, double budget_mb,
                                    uint32_t *radiance_size) {
  if (!(budget_mb > 0.0 && budget_mb < 1e12))
    return olx_fail(OLX_ERROR_ARGUMENT, "bake: the budget must be a number of megabytes above 0");
  uint64_t bytes = 0;
  for (uint32_t size = OLX_RADIANCE_SIZE_MOST; size >= OLX_RADIANCE_SIZE_LEAST; size /= 2) {
    OLX_TRY(size_with_maps(scene, settings, size, budget_mb * 1e6, &bytes));
    *radiance_size = size;
    if ((double)bytes <= budget_mb * 1e6) return OLX_OK;
  }
  return refuse_budget(settings, budget_mb, bytes);
}
