// Runs the steps of the irradiance volume: free space, its cells, their probes' light, and the share of surfaces
// without a cell.
#include "bake/volume/volume_bake.h"

#include "bake/volume/volume_light.h"
#include "core/hooks.h"
#include "core/result.h"

enum {
  RAYS = 256, // of a probe
  PROBES_A_UNIT = 1024,
  MOST_CELLS = 1 << 15, // beyond that they become larger
  VOXELS_A_CELL = 8,    // along a smallest cell, or fewer where space would have more than so many
  LEAST_VOXELS = 32,    // along the longest side of space
  MOST_VOXELS = 160
};

bool olx_volume_is_baked(const olx_bake_settings *s) { return s->light == OLX_LIGHT_CACHE && s->volume_cells > 0; }

static olx_result make_cells(olx_volume_bake *b) {
  const olx_bake_settings *settings = b->context->settings;
  const olx_probe_list *probes = &b->context->probes.light_field;
  const uint32_t along = olx_volume_cells_along(settings->radiance_size, settings->volume_cells),
                 wanted = VOXELS_A_CELL * along, threads = settings->threads;
  const uint32_t voxels = wanted < LEAST_VOXELS ? LEAST_VOXELS : wanted > MOST_VOXELS ? MOST_VOXELS : wanted;
  olx_volume_space space;
  OLX_TRY(olx_volume_space_create(b->context->scene, probes->positions, probes->flags, probes->count, voxels, threads,
                                  &space));
  const olx_result result = olx_volume_cells_create(&space, along, MOST_CELLS, threads, &b->cells);
  olx_volume_space_free(&space);
  return result;
}

static olx_result find_unserved(olx_volume_bake *b, double *share) {
  const olx_probe_list *probes = &b->context->probes.light_field;
  *share = 1.0;
  if (!b->cells.data) return OLX_OK;
  olx_volume volume;
  OLX_TRY(olx_volume_open(b->cells.data, b->cells.size_bytes, "bake", &volume));
  return olx_volume_unserved(b->context->scene, &volume, probes->positions, probes->flags, probes->count,
                             b->context->settings->threads, share);
}

olx_result olx_volume_bake_create(olx_volume_bake *b, olx_bake_stats *stats) {
  if (!olx_volume_is_baked(b->context->settings)) return OLX_OK;
  olx_task_stage(&b->context->task, "volume");
  const double start = olx_seconds();
  OLX_TRY(make_cells(b));
  OLX_TRY(find_unserved(b, &stats->volume_unserved));
  stats->volume_probes = b->cells.probe_count;
  stats->volume_cells = b->cells.cell_count;
  stats->volume_seconds += olx_seconds() - start;
  return OLX_OK;
}

// The light of probes, some of them a unit.
typedef struct light_stage {
  olx_volume_bake *bake;
  olx_volume_light light;
  uint16_t *irradiance; // of all probes
} light_stage;

uint32_t olx_volume_bake_units(const olx_volume_bake *b) {
  return b->cells.data ? (b->cells.probe_count + PROBES_A_UNIT - 1) / PROBES_A_UNIT : 0;
}

static uint32_t probes_in(const light_stage *v, uint32_t unit) {
  const uint32_t left = v->bake->cells.probe_count - unit * PROBES_A_UNIT;
  return left < PROBES_A_UNIT ? left : PROBES_A_UNIT;
}

static uint16_t *irradiance_of(const light_stage *v, uint32_t unit) {
  return v->irradiance + (size_t)unit * PROBES_A_UNIT * OLX_VOLUME_HALVES;
}

static olx_result light_unit(void *user, uint32_t unit) {
  light_stage *v = user;
  const olx_vec3 *positions = v->bake->cells.positions + (size_t)unit * PROBES_A_UNIT;
  return olx_volume_light_make(&v->light, positions, probes_in(v, unit), irradiance_of(v, unit));
}

static void save_unit(void *user, uint32_t unit, olx_byte_writer *to) {
  const light_stage *v = user;
  olx_bytes_put(to, irradiance_of(v, unit), (size_t)probes_in(v, unit) * OLX_VOLUME_HALVES, sizeof *v->irradiance);
}

static olx_result load_unit(void *user, uint32_t unit, olx_byte_reader *from) {
  const light_stage *v = user;
  olx_bytes_copy(from, irradiance_of(v, unit), (size_t)probes_in(v, unit) * OLX_VOLUME_HALVES, sizeof *v->irradiance);
  return OLX_OK;
}

static olx_result light_probes(light_stage *v, olx_unit_store *store, olx_field_writer *writer) {
  const uint32_t count = v->bake->cells.probe_count;
  const olx_unit_stage stage = {.name = "volume",
                                .count = olx_volume_bake_units(v->bake),
                                .user = v,
                                .make = light_unit,
                                .save = save_unit,
                                .load = load_unit};
  v->irradiance = olx_allocate((size_t)count * OLX_VOLUME_HALVES, sizeof *v->irradiance);
  if (!v->irradiance) return olx_fail(OLX_ERROR_MEMORY, "bake: out of memory for %u volume probes", count);
  OLX_TRY(olx_units_make(store, &stage));
  return writer ? olx_field_writer_volume(writer, v->irradiance) : OLX_OK;
}

olx_result olx_volume_bake_write(olx_volume_bake *b, const olx_scene_light *light, olx_unit_store *store,
                                 olx_field_writer *writer, olx_bake_stats *stats) {
  if (!b->cells.data) return OLX_OK;
  olx_task_stage(&b->context->task, "volume");
  const double start = olx_seconds();
  light_stage v = {.bake = b,
                   .light = {.scene = b->context->scene,
                             .light = light,
                             .rays = RAYS,
                             .seed = b->seed,
                             .threads = b->context->settings->threads,
                             .task = &b->context->task}};
  const olx_result result = light_probes(&v, store, writer);
  olx_release(v.irradiance);
  stats->rays += v.light.rays_cast;
  stats->volume_bytes = b->cells.size_bytes +
                        (uint64_t)b->cells.probe_count * (sizeof(olx_vec3) + OLX_VOLUME_HALVES * sizeof *v.irradiance);
  stats->volume_seconds += olx_seconds() - start;
  return result;
}

void olx_volume_bake_free(olx_volume_bake *b) { olx_volume_cells_free(&b->cells); }
