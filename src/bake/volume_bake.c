// Runs the steps of the irradiance volume: free space, its cells, their probes' light, and what they leave unserved.
#include "bake/volume_bake.h"

#include "bake/volume_light.h"
#include "core/hooks.h"
#include "core/result.h"

enum {
  RAYS = 256,           // of a probe
  MOST_CELLS = 1 << 15, // beyond that they become larger
  TEXELS_A_CELL = 16,   // of a light field map's side for one of the smallest cells along the space
  VOXELS_A_CELL = 8,    // along a smallest cell, or fewer where space would have more than so many
  LEAST_VOXELS = 32,    // along the longest side of space
  MOST_VOXELS = 160
};

bool olx_volume_is_baked(const olx_bake_settings *s) { return s->light == OLX_LIGHT_CACHE && s->volume_cells > 0; }

// Small maps of light field probes get a coarse volume.
static uint32_t cells_along(const olx_bake_settings *s) {
  const uint32_t most = s->radiance_size > TEXELS_A_CELL ? s->radiance_size / TEXELS_A_CELL : 1;
  return s->volume_cells < most ? s->volume_cells : most;
}

static olx_result make_cells(olx_volume_bake *b) {
  const uint32_t along = cells_along(b->settings), wanted = VOXELS_A_CELL * along, threads = b->settings->threads;
  const uint32_t voxels = wanted < LEAST_VOXELS ? LEAST_VOXELS : wanted > MOST_VOXELS ? MOST_VOXELS : wanted;
  olx_volume_space space;
  OLX_TRY(olx_volume_space_create(b->scene, b->positions, b->flags, b->probe_count, voxels, threads, &space));
  const olx_result result = olx_volume_cells_create(&space, along, MOST_CELLS, threads, &b->cells);
  olx_volume_space_free(&space);
  return result;
}

static olx_result find_unserved(olx_volume_bake *b, double *share) {
  *share = 1.0;
  if (!b->cells.data) return OLX_OK;
  olx_volume volume;
  OLX_TRY(olx_volume_open(b->cells.data, b->cells.size_bytes, "bake", &volume));
  return olx_volume_unserved(b->scene, &volume, b->positions, b->flags, b->probe_count, share);
}

olx_result olx_volume_bake_create(olx_volume_bake *b, olx_bake_stats *stats) {
  if (!olx_volume_is_baked(b->settings)) return OLX_OK;
  olx_task_stage(b->task, "volume");
  const double start = olx_seconds();
  OLX_TRY(make_cells(b));
  OLX_TRY(find_unserved(b, &stats->volume_unserved));
  stats->volume_probes = b->cells.probe_count;
  stats->volume_cells = b->cells.cell_count;
  stats->volume_seconds += olx_seconds() - start;
  return OLX_OK;
}

olx_result olx_volume_bake_write(olx_volume_bake *b, const olx_scene_light *light, olx_field_writer *writer,
                                 olx_bake_stats *stats) {
  if (!b->cells.data) return OLX_OK;
  olx_task_stage(b->task, "volume");
  const double start = olx_seconds();
  olx_volume_light volume = {.scene = b->scene,
                             .light = light,
                             .rays = RAYS,
                             .seed = b->seed,
                             .threads = b->settings->threads,
                             .task = b->task};
  uint16_t *irradiance = olx_allocate((size_t)b->cells.probe_count * OLX_VOLUME_HALVES, sizeof *irradiance);
  if (!irradiance) return olx_fail(OLX_ERROR_MEMORY, "bake: out of memory for %u volume probes", b->cells.probe_count);
  olx_result result = olx_volume_light_make(&volume, b->cells.positions, b->cells.probe_count, irradiance);
  if (result == OLX_OK) result = olx_field_writer_volume(writer, irradiance);
  olx_release(irradiance);
  stats->rays += volume.rays_cast;
  stats->volume_bytes = b->cells.size_bytes +
                        (uint64_t)b->cells.probe_count * (sizeof(olx_vec3) + OLX_VOLUME_HALVES * sizeof *irradiance);
  stats->volume_seconds += olx_seconds() - start;
  return result;
}

void olx_volume_bake_free(olx_volume_bake *b) { olx_volume_cells_free(&b->cells); }
