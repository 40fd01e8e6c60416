// Runs the stages of a bake: each computes its results, stores and reloads them, and writes them to the file.
#include "bake/bake_run.h"
#include "bake/capture/probe_gathers.h"

#include "core/hooks.h"
#include "core/result.h"

#include <string.h>

// ---- The plan

typedef struct plan_stage {
  olx_bake_run *run;
  olx_result (*make)(olx_bake_run *run);
} plan_stage;

// What the file stores about the scene, and the messages of the bake.
typedef struct plan_record {
  olx_bake_settings settings; // its pointers are not valid
  double origin[3];
  olx_vec3 bounds_min, bounds_max;
  uint32_t buried, irradiance_buried;
  uint32_t volume_probes, volume_cells;
  double volume_unserved;
} plan_record;

static plan_record record_of(const olx_bake_run *b) {
  const olx_scene *scene = b->context.scene;
  plan_record record;
  memset(&record, 0, sizeof record);
  record.settings = *b->context.settings;
  memcpy(record.origin, scene->origin, sizeof record.origin);
  record.bounds_min = scene->bounds_min;
  record.bounds_max = scene->bounds_max;
  record.buried = b->stats.buried;
  record.irradiance_buried = b->stats.irradiance_buried;
  record.volume_probes = b->volume.cells.probe_count;
  record.volume_cells = b->volume.cells.cell_count;
  record.volume_unserved = b->stats.volume_unserved;
  return record;
}

static olx_result make_plan(void *user, uint32_t unit) {
  (void)unit;
  const plan_stage *p = user;
  return p->make(p->run);
}

// Writes a block of bytes that may be absent.
static void put_blob(olx_byte_writer *to, const void *data, size_t size_bytes) {
  const uint64_t size = data ? size_bytes : 0;
  olx_bytes_put(to, &size, 1, sizeof size);
  olx_bytes_put(to, data, size, 1);
}

static void *take_blob(olx_byte_reader *from, size_t *size_bytes) {
  uint64_t size = 0;
  olx_bytes_copy(from, &size, 1, sizeof size);
  *size_bytes = size;
  return size ? olx_bytes_take(from, size, 1) : NULL;
}

static void put_probes(olx_byte_writer *to, const olx_probe_list *probes) {
  olx_bytes_put(to, &probes->count, 1, sizeof probes->count);
  olx_bytes_put(to, probes->positions, probes->count, sizeof *probes->positions);
  olx_bytes_put(to, probes->flags, probes->count, 1);
}

// Reads the probes of the plan; joining allocates them first, because it has none yet.
static olx_result take_probes(olx_byte_reader *from, olx_probe_list *probes) {
  olx_bytes_copy(from, &probes->count, 1, sizeof probes->count);
  if (!probes->positions) probes->positions = olx_allocate(probes->count, sizeof *probes->positions);
  if (!probes->flags) probes->flags = olx_allocate(probes->count, 1);
  if (!probes->positions || !probes->flags) return olx_fail(OLX_ERROR_MEMORY, "bake: out of memory for probes");
  olx_bytes_copy(from, probes->positions, probes->count, sizeof *probes->positions);
  olx_bytes_copy(from, probes->flags, probes->count, 1);
  return OLX_OK;
}

static void save_plan(void *user, uint32_t unit, olx_byte_writer *to) {
  (void)unit;
  const olx_bake_run *b = ((const plan_stage *)user)->run;
  const plan_record record = record_of(b);
  olx_bytes_put(to, &record, 1, sizeof record);
  put_probes(to, &b->context.probes.light_field);
  put_probes(to, &b->context.probes.irradiance);
  for (uint32_t i = 0; i < OLX_SELECT_STORED; i++) put_blob(to, b->selectors.data[i], b->selectors.size_bytes[i]);
  put_blob(to, b->volume.cells.data, b->volume.cells.size_bytes);
  put_blob(to, b->volume.cells.positions, b->volume.cells.probe_count * sizeof *b->volume.cells.positions);
  put_blob(to, b->classic_table, b->classic_table ? OLX_CLASSIC_TABLE_ENTRIES * sizeof *b->classic_table : 0);
}

// Sets the scene's properties and the settings from the plan, for joining, which has neither.
static void take_record(olx_bake_run *b, const plan_record *record) {
  b->stats.buried = record->buried;
  b->stats.irradiance_buried = record->irradiance_buried;
  b->stats.volume_probes = record->volume_probes;
  b->stats.volume_cells = record->volume_cells;
  b->stats.volume_unserved = record->volume_unserved;
  b->volume.context = &b->context;
  b->volume.seed = b->shade.seed;
  b->volume.cells.probe_count = record->volume_probes;
  b->volume.cells.cell_count = record->volume_cells;
  if (!b->joined) return;
  olx_joined_bake *joined = b->joined;
  joined->settings = record->settings;
  joined->settings.raster = NULL;
  joined->settings.work = (olx_bake_work){0};
  joined->settings.threads = 0;
  joined->settings.memory_limit_bytes = 0;
  if (joined->settings.probes) joined->settings.probes = b->context.probes.light_field.positions;
  joined->scene.bounds_min = record->bounds_min;
  joined->scene.bounds_max = record->bounds_max;
  memcpy(joined->scene.origin, record->origin, sizeof record->origin);
  b->context.distance_scale = olx_length(olx_sub(record->bounds_max, record->bounds_min));
}

static olx_result load_plan(void *user, uint32_t unit, olx_byte_reader *from) {
  (void)unit;
  olx_bake_run *b = ((const plan_stage *)user)->run;
  plan_record record = {.buried = 0};
  size_t ignored;
  olx_bytes_copy(from, &record, 1, sizeof record);
  OLX_TRY(take_probes(from, &b->context.probes.light_field));
  OLX_TRY(take_probes(from, &b->context.probes.irradiance));
  for (uint32_t i = 0; i < OLX_SELECT_STORED; i++) {
    b->selectors.data[i] = take_blob(from, &b->selectors.size_bytes[i]);
  }
  b->volume.cells.data = take_blob(from, &b->volume.cells.size_bytes);
  b->volume.cells.positions = take_blob(from, &ignored);
  b->classic_table = take_blob(from, &ignored);
  take_record(b, &record);
  return OLX_OK;
}

// ---- What the file stores about the scene's light, for joining

static olx_result make_scene(void *user, uint32_t unit) {
  (void)unit;
  olx_bake_run *b = user;
  return olx_surface_lights(b->context.scene, &b->lights);
}

static void save_scene(void *user, uint32_t unit, olx_byte_writer *to) {
  (void)unit;
  const olx_bake_run *b = user;
  const olx_scene *scene = b->context.scene;
  olx_bytes_put(to, &scene->hash, 1, sizeof scene->hash);
  olx_bytes_put(to, &scene->light_count, 1, sizeof scene->light_count);
  olx_bytes_put(to, b->lights, scene->light_count, sizeof *b->lights);
}

static olx_result load_scene(void *user, uint32_t unit, olx_byte_reader *from) {
  (void)unit;
  olx_bake_run *b = user;
  uint64_t hash = 0;
  uint32_t light_count = 0;
  olx_bytes_copy(from, &hash, 1, sizeof hash);
  olx_bytes_copy(from, &light_count, 1, sizeof light_count);
  b->lights = olx_bytes_take(from, light_count, sizeof *b->lights);
  if (b->joined) b->joined->scene.hash = hash;
  if (b->joined) b->joined->scene.light_count = light_count;
  return OLX_OK;
}

olx_result olx_bake_plan(olx_bake_run *b, olx_result (*make)(olx_bake_run *run)) {
  plan_stage p = {b, make};
  // Where no camera is in free space, the volume fills the spaces that light reaches.
  const olx_unit_stage plan = {"plan", 0, 1, &p, make_plan, save_plan, load_plan, OLX_PARTS_ALL};
  const olx_unit_stage scene = {"scene", 0, 1, b, make_scene, save_scene, load_scene, OLX_PARTS_ALL};
  OLX_TRY(olx_unit_once(b->store, &plan));
  return olx_unit_once(b->store, &scene);
}

// ---- Statistics of the solved light

typedef struct facts_stage {
  olx_bake_run *run;
  float last_bounce;
} facts_stage;

static olx_result make_facts(void *user, uint32_t unit) {
  (void)unit;
  facts_stage *f = user;
  f->last_bounce = (float)olx_scene_light_describe(f->run->light).last_bounce;
  return OLX_OK;
}

static void save_facts(void *user, uint32_t unit, olx_byte_writer *to) {
  (void)unit;
  const facts_stage *f = user;
  olx_bytes_put(to, &f->last_bounce, 1, sizeof f->last_bounce);
}

static olx_result load_facts(void *user, uint32_t unit, olx_byte_reader *from) {
  (void)unit;
  facts_stage *f = user;
  olx_bytes_copy(from, &f->last_bounce, 1, sizeof f->last_bounce);
  return OLX_OK;
}

olx_result olx_bake_facts(olx_bake_run *b) {
  facts_stage f = {.run = b};
  const olx_unit_stage stage = {"facts", 0, 1, &f, make_facts, save_facts, load_facts, OLX_PARTS_ALL};
  if (b->context.settings->light == OLX_LIGHT_REFERENCE) return OLX_OK;
  OLX_TRY(olx_units_make(b->store, &stage));
  if (b->writer) olx_field_writer_last_bounce(b->writer, f.last_bounce);
  return OLX_OK;
}

// ---- Irradiance probes: their fit to surfaces couples them, so that all are one unit

typedef struct irradiance_stage {
  olx_bake_run *run;
  olx_result (*make)(olx_bake_run *run);
  uint32_t *record; // record of one probe
  size_t words;
} irradiance_stage;

static olx_result write_irradiance(const irradiance_stage *s, uint32_t probe, const uint32_t *record) {
  olx_bake_run *b = s->run;
  if (!b->writer) return OLX_OK;
  const double start = olx_seconds();
  OLX_TRY(olx_field_writer_irradiance(b->writer, probe, b->context.probes.irradiance.flags[probe], record,
                                      record + s->words / 2));
  b->stats.write_seconds += olx_seconds() - start;
  return OLX_OK;
}

static olx_result make_irradiance(void *user, uint32_t unit) {
  (void)unit;
  const irradiance_stage *s = user;
  olx_bake_run *b = s->run;
  OLX_TRY(s->make(b));
  OLX_TRY(olx_gather_finish(&b->gather));
  for (uint32_t i = 0; b->writer && i < b->context.probes.irradiance.count; i++) {
    OLX_TRY(olx_gather_pack(&b->gather, i, s->record));
    OLX_TRY(write_irradiance(s, i, s->record));
  }
  return OLX_OK;
}

static void save_irradiance(void *user, uint32_t unit, olx_byte_writer *to) {
  (void)unit;
  const irradiance_stage *s = user;
  for (uint32_t i = 0; i < s->run->context.probes.irradiance.count; i++) {
    to->failed |= olx_gather_pack(&s->run->gather, i, s->record) != OLX_OK;
    olx_bytes_put(to, s->record, s->words, sizeof *s->record);
  }
}

static olx_result load_irradiance(void *user, uint32_t unit, olx_byte_reader *from) {
  (void)unit;
  const irradiance_stage *s = user;
  for (uint32_t i = 0; i < s->run->context.probes.irradiance.count; i++) {
    olx_bytes_copy(from, s->record, s->words, sizeof *s->record);
    if (!from->failed) OLX_TRY(write_irradiance(s, i, s->record));
  }
  return OLX_OK;
}

olx_result olx_bake_irradiance(olx_bake_run *b, olx_result (*make)(olx_bake_run *run)) {
  irradiance_stage s = {.run = b, .make = make, .words = olx_gather_record_words(&b->gather)};
  const olx_unit_stage stage = {"irradiance", 0, 1, &s, make_irradiance, save_irradiance, load_irradiance,
                                OLX_PARTS_ALL};
  if (!b->context.probes.irradiance.count) return OLX_OK;
  s.record = olx_allocate_zero(s.words, sizeof *s.record);
  if (!s.record) return olx_fail(OLX_ERROR_MEMORY, "bake: out of memory for an irradiance map");
  const olx_result result = olx_units_make(b->store, &stage);
  olx_release(s.record);
  return result;
}

// ---- Classic maps

typedef struct classic_stage {
  olx_bake_run *run;
  olx_classic_record record; // record of the latest probe
} classic_stage;

static size_t classic_texels(const olx_bake_run *b, uint32_t level) {
  const size_t side = olx_classic_side(b->context.settings->classic_size, level);
  return side * side;
}

static olx_result write_classic(const classic_stage *c, uint32_t probe, const olx_classic_record *record) {
  olx_bake_run *b = c->run;
  if (!b->writer) return OLX_OK;
  const double start = olx_seconds();
  OLX_TRY(olx_field_writer_classic(b->writer, probe, record));
  b->stats.write_seconds += olx_seconds() - start;
  return OLX_OK;
}

static olx_result make_classic(void *user, uint32_t probe) {
  classic_stage *c = user;
  olx_bake_run *b = c->run;
  OLX_TRY(olx_classic_bake_probe(&b->classic, probe, b->context.probes.irradiance.positions[probe], &c->record));
  return write_classic(c, probe, &c->record);
}

static void save_classic(void *user, uint32_t probe, olx_byte_writer *to) {
  (void)probe;
  const classic_stage *c = user;
  olx_bytes_put(to, c->record.irradiance, classic_texels(c->run, 0), sizeof *c->record.irradiance);
  for (uint32_t level = 0; level < OLX_CLASSIC_LEVELS; level++) {
    olx_bytes_put(to, c->record.radiance[level], classic_texels(c->run, level), sizeof *c->record.radiance[level]);
  }
  olx_bytes_put(to, &c->record.box, 1, sizeof c->record.box);
}

static olx_result load_classic(void *user, uint32_t probe, olx_byte_reader *from) {
  const classic_stage *c = user;
  olx_classic_record record = {.irradiance = olx_bytes_get(from, classic_texels(c->run, 0), sizeof *record.irradiance)};
  for (uint32_t level = 0; level < OLX_CLASSIC_LEVELS; level++) {
    record.radiance[level] = olx_bytes_get(from, classic_texels(c->run, level), sizeof *record.radiance[level]);
  }
  olx_bytes_copy(from, &record.box, 1, sizeof record.box);
  return from->failed ? OLX_OK : write_classic(c, probe, &record);
}

olx_result olx_bake_classic(olx_bake_run *b) {
  classic_stage c = {.run = b};
  const olx_unit_stage stage = {
      "classic", 0, b->context.probes.irradiance.count, &c, make_classic, save_classic, load_classic, OLX_PARTS_ALL};
  if (!b->context.settings->classic) return OLX_OK;
  olx_task_stage(&b->context.task, "classic maps");
  b->classic.bounces = b->bounces;
  const double start = olx_seconds();
  OLX_TRY(olx_units_make(b->store, &stage));
  b->stats.classic_seconds = olx_seconds() - start;
  return OLX_OK;
}

// ---- Relighting

static olx_result make_relight(void *user, uint32_t unit) {
  (void)unit;
  olx_bake_run *b = user;
  if (b->store) OLX_TRY(olx_scene_light_load_links(b->light));
  OLX_TRY(olx_relight_bake_create(&b->relight));
  return olx_relight_bake_volume(&b->relight, b->volume.cells.positions, b->volume.cells.probe_count);
}

static void save_relight(void *user, uint32_t unit, olx_byte_writer *to) {
  (void)unit;
  olx_relight_bake_save(&((const olx_bake_run *)user)->relight, to);
}

static olx_result load_relight(void *user, uint32_t unit, olx_byte_reader *from) {
  (void)unit;
  return olx_relight_bake_load(&((olx_bake_run *)user)->relight, from);
}

olx_result olx_bake_relight(olx_bake_run *b) {
  const olx_unit_stage stage = {"relight", 0, 1, b, make_relight, save_relight, load_relight, OLX_PARTS_ALL};
  if (!b->context.settings->relight) return OLX_OK;
  olx_task_stage(&b->context.task, "relighting");
  const double start = olx_seconds();
  b->relight = (olx_relight_bake){.context = &b->context, .light = b->light, .seed = b->shade.seed};
  if (b->light) OLX_TRY(olx_relight_bake_look_up(&b->relight)); // joining has no light, and looks nothing up
  OLX_TRY(olx_units_make(b->store, &stage));
  b->stats.relight_seconds = olx_seconds() - start;
  return OLX_OK;
}

// ---- Light field probes

// What a light field probe writes to the file.
typedef struct probe_maps {
  olx_surface_maps surfaces;
  const uint32_t *radiance;               // NULL without probe light
  const uint16_t *normal, *distance;      // NULL where the field stores blocks
  olx_geometry_map geometry;              // where the field stores blocks
  olx_tiled_maps tiled[OLX_SURFACE_MAPS]; // read from a work folder; `surfaces` points to them then
  olx_relight_sites sites;                // empty without relighting
} probe_maps;

typedef struct probe_stage {
  olx_bake_run *run;
  probe_maps made; // maps of the latest probe
  olx_probe_gathers gathers;
} probe_stage;

static olx_result write_geometry(olx_bake_run *b, uint32_t probe, const probe_maps *maps) {
  const uint8_t flags = b->context.probes.light_field.flags[probe];
  if (b->context.settings->uncompressed) {
    return olx_field_writer_probe(b->writer, probe, flags, maps->radiance, maps->normal, maps->distance);
  }
  return olx_field_writer_probe_blocks(b->writer, probe, flags, maps->radiance, &maps->geometry);
}

static olx_result write_probe(olx_bake_run *b, uint32_t probe, const probe_maps *maps) {
  if (!b->writer) return OLX_OK;
  const double start = olx_seconds();
  OLX_TRY(write_geometry(b, probe, maps));
  OLX_TRY(olx_field_writer_surface(b->writer, probe, &maps->surfaces));
  b->stats.write_seconds += olx_seconds() - start;
  return b->context.settings->relight ? olx_relight_bake_probe(&b->relight, &maps->sites) : OLX_OK;
}

static olx_result find_sites(olx_bake_run *b, olx_relight_sites *sites) {
  const double start = olx_seconds();
  olx_relight_sites_free(sites);
  if (!b->context.settings->relight) return OLX_OK;
  OLX_TRY(olx_relight_sites_add(sites, &b->capture, &b->relight.lookup));
  b->stats.relight_seconds += olx_seconds() - start;
  return OLX_OK;
}

static olx_result measure_embree(olx_bake_run *b) {
  const double start = olx_seconds();
  if (b->context.settings->measure_embree) OLX_TRY(olx_capture_measure(&b->capture, &b->stats.embree_seconds));
  b->measure_seconds += olx_seconds() - start;
  return OLX_OK;
}

static olx_result make_probe(void *user, uint32_t probe) {
  probe_stage *s = user;
  olx_bake_run *b = s->run;
  const double start = olx_seconds();
  OLX_TRY(olx_capture_probe(&b->capture, probe, b->context.probes.light_field.positions[probe]));
  olx_probe_gathers_begin(&s->gathers, probe);
  OLX_TRY(olx_surface_capture_probe(&b->surfaces, b->context.probes.light_field.flags[probe] & OLX_PROBE_BURIED,
                                    &s->made.surfaces));
  OLX_TRY(olx_probe_gathers_end(&s->gathers, probe));
  b->stats.capture_seconds += olx_seconds() - start;
  s->made.radiance = b->surfaces.radiance;
  s->made.normal = b->capture.normal;
  s->made.distance = b->capture.distance;
  s->made.geometry = b->surfaces.geometry.map;
  OLX_TRY(find_sites(b, &s->made.sites));
  OLX_TRY(measure_embree(b));
  return write_probe(b, probe, &s->made);
}

// The numbers of elements in a map of a probe.
typedef struct map_shapes {
  size_t texels, blocks, tiles;
} map_shapes;

static map_shapes shapes_of(const olx_bake_run *b) {
  const size_t size = b->context.settings->radiance_size, texels = size * size;
  return (map_shapes){texels, texels / OLX_BLOCK_TEXELS, texels / OLX_TILE_TEXELS};
}

static void save_geometry(const olx_bake_run *b, const probe_maps *m, olx_byte_writer *to) {
  const map_shapes shapes = shapes_of(b);
  if (b->context.settings->uncompressed) {
    olx_bytes_put(to, m->normal, shapes.texels, sizeof *m->normal);
    olx_bytes_put(to, m->distance, shapes.texels, sizeof *m->distance);
    return;
  }
  const olx_plane_pool *pool = &m->geometry.pool;
  olx_bytes_put(to, m->geometry.blocks, shapes.blocks, sizeof *m->geometry.blocks);
  olx_bytes_put(to, &pool->count, 1, sizeof pool->count);
  if (pool->count) olx_bytes_put(to, pool->planes, pool->count, sizeof *pool->planes);
}

static void load_geometry(const olx_bake_run *b, olx_byte_reader *from, probe_maps *m) {
  const map_shapes shapes = shapes_of(b);
  if (b->context.settings->uncompressed) {
    m->normal = olx_bytes_get(from, shapes.texels, sizeof *m->normal);
    m->distance = olx_bytes_get(from, shapes.texels, sizeof *m->distance);
    return;
  }
  olx_plane_pool *pool = &m->geometry.pool;
  m->geometry.blocks = olx_bytes_get(from, shapes.blocks, sizeof *m->geometry.blocks);
  olx_bytes_copy(from, &pool->count, 1, sizeof pool->count);
  if (pool->count) pool->planes = olx_bytes_get(from, pool->count, sizeof *pool->planes);
}

static void save_surfaces(const olx_bake_run *b, const olx_surface_maps *m, olx_byte_writer *to) {
  const map_shapes shapes = shapes_of(b);
  for (uint32_t map = 0; map < OLX_SURFACE_MAPS && m->tiled; map++) {
    const olx_tiled_maps *tiled = &m->tiled[map];
    olx_bytes_put(to, tiled->words, shapes.tiles, sizeof *tiled->words);
    olx_bytes_put(to, &tiled->count, 1, sizeof tiled->count);
    if (tiled->count) olx_bytes_put(to, tiled->blocks, tiled->count, olx_surface_block_bytes(map));
  }
  if (m->tiled) return;
  olx_bytes_put(to, m->base, shapes.texels, sizeof(uint32_t));
  olx_bytes_put(to, m->specular, shapes.texels, sizeof(uint16_t));
  olx_bytes_put(to, m->direct, shapes.texels, sizeof(uint32_t));
  olx_bytes_put(to, m->indirect, shapes.texels, sizeof(uint32_t));
}

static void load_surfaces(const olx_bake_run *b, olx_byte_reader *from, probe_maps *m) {
  const map_shapes shapes = shapes_of(b);
  if (b->context.settings->uncompressed) {
    m->surfaces.base = olx_bytes_get(from, shapes.texels, sizeof(uint32_t));
    m->surfaces.specular = olx_bytes_get(from, shapes.texels, sizeof(uint16_t));
    m->surfaces.direct = olx_bytes_get(from, shapes.texels, sizeof(uint32_t));
    m->surfaces.indirect = olx_bytes_get(from, shapes.texels, sizeof(uint32_t));
    return;
  }
  for (uint32_t map = 0; map < OLX_SURFACE_MAPS; map++) {
    olx_tiled_maps *tiled = &m->tiled[map];
    tiled->words = olx_bytes_get(from, shapes.tiles, sizeof *tiled->words);
    olx_bytes_copy(from, &tiled->count, 1, sizeof tiled->count);
    if (tiled->count) tiled->blocks = olx_bytes_get(from, tiled->count, olx_surface_block_bytes(map));
  }
  m->surfaces.tiled = m->tiled;
}

static bool is_dark(const uint32_t *emission, size_t texels) {
  for (size_t i = 0; i < texels; i++) {
    if (emission[i]) return false;
  }
  return true;
}

static void save_probe(void *user, uint32_t probe, olx_byte_writer *to) {
  (void)probe;
  const probe_stage *s = user;
  const probe_maps *m = &s->made;
  const map_shapes shapes = shapes_of(s->run);
  const uint32_t emits = !is_dark(m->surfaces.emission, shapes.texels);
  olx_bytes_put(to, &emits, 1, sizeof emits);
  save_geometry(s->run, m, to);
  save_surfaces(s->run, &m->surfaces, to);
  if (emits) olx_bytes_put(to, m->surfaces.emission, shapes.texels, sizeof *m->surfaces.emission);
  if (m->radiance) olx_bytes_put(to, m->radiance, shapes.texels, sizeof *m->radiance);
  if (s->run->context.settings->relight) olx_relight_sites_save(&m->sites, to);
}

static olx_result load_maps(const olx_bake_run *b, olx_byte_reader *from, uint32_t *dark, probe_maps *m) {
  const map_shapes shapes = shapes_of(b);
  uint32_t emits = 0;
  olx_bytes_copy(from, &emits, 1, sizeof emits);
  load_geometry(b, from, m);
  load_surfaces(b, from, m);
  m->surfaces.emission = emits ? olx_bytes_get(from, shapes.texels, sizeof *m->surfaces.emission) : dark;
  if (b->context.probes.irradiance.count) m->radiance = olx_bytes_get(from, shapes.texels, sizeof *m->radiance);
  return b->context.settings->relight ? olx_relight_sites_load(&m->sites, from) : OLX_OK;
}

static olx_result load_probe(void *user, uint32_t probe, olx_byte_reader *from) {
  const probe_stage *s = user;
  probe_maps maps = {.radiance = NULL};
  uint32_t *dark = olx_allocate_zero(shapes_of(s->run).texels, sizeof *dark);
  olx_result result = dark ? OLX_OK : olx_fail(OLX_ERROR_MEMORY, "bake: out of memory for a map");
  if (result == OLX_OK) result = load_maps(s->run, from, dark, &maps);
  if (result == OLX_OK && !from->failed) result = write_probe(s->run, probe, &maps);
  olx_relight_sites_free(&maps.sites);
  olx_release(dark);
  olx_task_advance(&s->run->context.task, olx_capture_units(&s->run->capture));
  return result;
}

olx_result olx_bake_probes(olx_bake_run *b) {
  probe_stage s = {.run = b};
  const olx_unit_stage stage = {
      "probe", 0, b->context.probes.light_field.count, &s, make_probe, save_probe, load_probe, OLX_PARTS_ALL};
  olx_task_stage(&b->context.task, "light field");
  OLX_TRY(olx_probe_gathers_create(&s.gathers, b));
  b->surfaces.rows = s.gathers.rows;
  olx_result result = olx_units_make(b->store, &stage);
  if (result == OLX_OK) result = olx_probe_gathers_finish(&s.gathers);
  b->surfaces.rows = NULL;
  olx_probe_gathers_free(&s.gathers);
  olx_relight_sites_free(&s.made.sites);
  if (result != OLX_OK || !b->context.settings->relight || !b->writer) return result;
  return olx_relight_bake_write(&b->relight, b->writer);
}

// ---- All stages of the file

typedef struct stored_stage {
  const char *name;
  uint32_t count;
} stored_stage;

enum { STORED_STAGES = 6 };

static void list_stored(const olx_bake_run *b, stored_stage stages[STORED_STAGES]) {
  const olx_bake_settings *s = b->context.settings;
  const uint32_t irradiance = b->context.probes.irradiance.count;
  const stored_stage all[STORED_STAGES] = {{"facts", s->light == OLX_LIGHT_CACHE},
                                           {"volume", olx_volume_bake_units(&b->volume)},
                                           {"irradiance", irradiance > 0},
                                           {"classic", s->classic ? irradiance : 0},
                                           {"relight", s->relight},
                                           {"probe", b->context.probes.light_field.count}};
  memcpy(stages, all, sizeof all);
}

bool olx_bake_is_stored(const olx_bake_run *b) {
  stored_stage stages[STORED_STAGES];
  list_stored(b, stages);
  bool stored = true;
  for (uint32_t i = 0; i < STORED_STAGES; i++) stored &= olx_units_have_all(b->store, stages[i].name, stages[i].count);
  return stored;
}

olx_result olx_bake_await(const olx_bake_run *b) {
  stored_stage stages[STORED_STAGES];
  list_stored(b, stages);
  for (uint32_t i = 0; i < STORED_STAGES; i++) {
    const olx_unit_stage stage = {.name = stages[i].name, .count = stages[i].count, .parts = OLX_PARTS_ALL};
    OLX_TRY(olx_units_await(b->store, &stage));
  }
  return OLX_OK;
}
