// Stores the gathers of probes' texels, and reads those that were stored for another scene.
#include "bake/capture/probe_gathers.h"

#include "bake/capture/texel_blocks.h"
#include "core/hooks.h"
#include "core/result.h"

typedef struct gathers_header {
  uint64_t surfels_hash;
  olx_scene_inputs inputs;
  uint64_t rows;
} gathers_header;

static void save_gathers(void *user, uint32_t unit, olx_byte_writer *to) {
  (void)unit;
  const olx_probe_gathers *g = user;
  const gathers_header header = {g->surfels_hash, g->inputs, g->row_count};
  olx_bytes_put(to, &header, 1, sizeof header);
  for (uint32_t i = 0; i < g->row_count; i++) {
    const uint64_t size_bytes = g->rows[i].kept.size_bytes;
    to->failed |= g->rows[i].kept.failed;
    olx_bytes_put(to, &size_bytes, 1, sizeof size_bytes);
    olx_bytes_put(to, g->rows[i].kept.data, size_bytes, 1);
  }
}

// Each probe is a round of one unit. Nothing loads it but a bake of an edited scene.
static olx_unit_stage stage_of(olx_probe_gathers *g, uint32_t probe) {
  return (olx_unit_stage){"gathers", probe, 1, g, NULL, save_gathers, NULL, OLX_PARTS_ALL};
}

olx_result olx_probe_gathers_create(olx_probe_gathers *g, olx_bake_run *run) {
  *g = (olx_probe_gathers){.run = run};
  if (!run->light || !olx_bake_keeps_rays(run)) return OLX_OK;
  g->row_count = run->context.settings->radiance_size / OLX_BLOCK_SIDE;
  g->surfels_hash = olx_scene_light_surfels_hash(run->light);
  g->inputs = olx_scene_hash_inputs(run->context.scene);
  g->rows = olx_allocate_zero(g->row_count, sizeof *g->rows);
  return g->rows ? OLX_OK : olx_fail(OLX_ERROR_MEMORY, "bake: out of memory for gathers of %u rows", g->row_count);
}

static void clear(olx_probe_gathers *g) {
  for (uint32_t i = 0; g->rows && i < g->row_count; i++) {
    olx_byte_writer_free(&g->rows[i].kept);
    g->rows[i] = (olx_gather_row){0};
  }
  olx_release(g->former);
  g->former = NULL;
}

void olx_probe_gathers_free(olx_probe_gathers *g) {
  clear(g);
  olx_release(g->rows);
  g->rows = NULL;
}

static void read_rows(olx_probe_gathers *g, size_t size_bytes) {
  olx_byte_reader reader = {.data = g->former, .size_bytes = size_bytes};
  const gathers_header *header = olx_bytes_get(&reader, 1, sizeof *header);
  uint64_t changed = 0;
  if (!header || header->surfels_hash != g->surfels_hash || header->inputs.surfaces != g->inputs.surfaces) return;
  for (uint32_t i = 0; i < OLX_INPUT_SLOTS; i++) {
    changed |= (uint64_t)(header->inputs.slots[i] != g->inputs.slots[i]) << i;
  }
  for (uint32_t i = 0; i < g->row_count && i < header->rows; i++) {
    uint64_t row_bytes = 0;
    olx_bytes_copy(&reader, &row_bytes, 1, sizeof row_bytes);
    const void *row = olx_bytes_get(&reader, row_bytes, 1);
    if (!row) return;
    g->rows[i].former = (olx_byte_reader){.data = row, .size_bytes = row_bytes};
    g->rows[i].changed = changed;
  }
}

void olx_probe_gathers_begin(olx_probe_gathers *g, uint32_t probe) {
  size_t size_bytes;
  if (!g->rows) return;
  clear(g);
  const olx_unit_stage stage = stage_of(g, probe);
  olx_units_read_stale(g->run->store, &stage, 0, &g->former, &size_bytes);
  if (g->former) read_rows(g, size_bytes);
}

olx_result olx_probe_gathers_end(olx_probe_gathers *g, uint32_t probe) {
  if (!g->rows) return OLX_OK;
  const olx_unit_stage stage = stage_of(g, probe);
  for (uint32_t i = 0; i < g->row_count; i++) g->run->stats.reused_rays += g->rows[i].reused;
  return olx_unit_keep(g->run->store, &stage);
}
