// Stores the gathers of probes' texels, and reads those that were stored for another scene.
#include "bake/capture/probe_gathers.h"

#include "bake/capture/texel_blocks.h"
#include "core/hooks.h"
#include "core/result.h"

// The slot OLX_INPUT_SURFELS of the inputs names the surfels.
typedef struct gathers_header {
  olx_scene_inputs inputs;
  uint64_t rows;
} gathers_header;

static void save_gathers(void *user, uint32_t unit, olx_byte_writer *to) {
  (void)unit;
  const olx_probe_gathers *g = user;
  const gathers_header header = {g->inputs, g->row_count};
  size_t all_bytes = sizeof header + OLX_BYTES_ALIGNMENT;
  for (uint32_t i = 0; i < g->row_count; i++) all_bytes += g->rows[i].kept.size_bytes + 2 * OLX_BYTES_ALIGNMENT;
  olx_bytes_reserve(to, all_bytes);
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

static void save_surfels(void *user, uint32_t unit, olx_byte_writer *to) {
  (void)unit;
  const olx_probe_gathers *g = user;
  olx_surfels_remember(olx_scene_light_open(g->run->light).surfels, &g->inputs, to);
}

// The surfels at which gathers end, which have a round of their own beside those of cast rays (light_units.c).
static olx_unit_stage surfels_of(olx_probe_gathers *g) {
  return (olx_unit_stage){"surfels", OLX_GATHER_SURFELS, 1, g, NULL, save_surfels, NULL, OLX_PARTS_ALL};
}

static olx_result read_surfels(olx_probe_gathers *g) {
  const olx_unit_stage stage = surfels_of(g);
  void *data;
  size_t size_bytes;
  olx_units_read_stale(g->run->store, &stage, 0, &data, &size_bytes);
  if (!data) return OLX_OK;
  olx_byte_reader reader = {.data = data, .size_bytes = size_bytes};
  const olx_result result =
      olx_former_surfels_read(&g->earlier, &reader, olx_scene_light_open(g->run->light).surfels, &g->inputs);
  olx_release(data);
  return result;
}

olx_result olx_probe_gathers_create(olx_probe_gathers *g, olx_bake_run *run) {
  *g = (olx_probe_gathers){.run = run};
  if (!run->light || !olx_bake_keeps_rays(run)) return OLX_OK;
  g->row_count = run->context.settings->radiance_size / OLX_BLOCK_SIDE;
  const olx_light_surfels *surfels = olx_scene_light_open(run->light).surfels;
  olx_scene_inputs scene;
  OLX_TRY(olx_scene_hash_inputs(run->context.scene, &scene));
  g->inputs = olx_surfels_inputs(surfels, olx_surfels_hash(surfels), &scene);
  OLX_TRY(read_surfels(g));
  g->rows = olx_allocate_zero(g->row_count, sizeof *g->rows);
  return g->rows ? OLX_OK : olx_fail(OLX_ERROR_MEMORY, "bake: out of memory for gathers of %u rows", g->row_count);
}

// Empties the rows, whose memory stays for the next probe.
static void clear(olx_probe_gathers *g) {
  for (uint32_t i = 0; g->rows && i < g->row_count; i++) {
    const olx_byte_writer kept = g->rows[i].kept;
    g->rows[i] = (olx_gather_row){.kept = {.data = kept.data, .capacity = kept.capacity}};
  }
  olx_release(g->former);
  g->former = NULL;
}

void olx_probe_gathers_free(olx_probe_gathers *g) {
  clear(g);
  for (uint32_t i = 0; g->rows && i < g->row_count; i++) olx_byte_writer_free(&g->rows[i].kept);
  olx_former_surfels_free(&g->earlier);
  olx_release(g->rows);
  g->rows = NULL;
}

static void read_rows(olx_probe_gathers *g, size_t size_bytes) {
  olx_byte_reader reader = {.data = g->former, .size_bytes = size_bytes};
  const gathers_header *header = olx_bytes_get(&reader, 1, sizeof *header);
  if (!header) return;
  const olx_surfels_name before = olx_surfels_name_of(&header->inputs), now = olx_surfels_name_of(&g->inputs);
  const bool same = olx_surfels_same_name(&before, &now);
  if (!same && !(g->earlier.count > 0 && olx_surfels_same_name(&before, &g->earlier.name))) return;
  const uint64_t changed = olx_inputs_changed(&header->inputs, &g->inputs);
  for (uint32_t i = 0; i < g->row_count && i < header->rows; i++) {
    uint64_t row_bytes = 0;
    olx_bytes_copy(&reader, &row_bytes, 1, sizeof row_bytes);
    const void *row = olx_bytes_get(&reader, row_bytes, 1);
    if (!row) return;
    g->rows[i].former = (olx_byte_reader){.data = row, .size_bytes = row_bytes};
    g->rows[i].changed = changed;
    g->rows[i].earlier = same ? NULL : &g->earlier;
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
  for (uint32_t i = 0; i < g->row_count; i++) {
    g->run->stats.rays += g->rows[i].rays;
    g->run->stats.reused_rays += g->rows[i].reused;
  }
  return olx_unit_keep(g->run->store, &stage);
}

olx_result olx_probe_gathers_finish(olx_probe_gathers *g) {
  if (!g->rows) return OLX_OK;
  const olx_unit_stage stage = surfels_of(g);
  return olx_units_have(g->run->store, &stage) ? OLX_OK : olx_unit_keep(g->run->store, &stage);
}
