// Runs the steps that solve a scene's light as units: rays by groups of surfels, arrays by ranges, and one unit for the
// result of each round, from which another run, or another partial bake, continues.
#include "light/solution/light_units.h"

#include "core/hooks.h"
#include "core/result.h"
#include "light/links/kept_rays.h"
#include "light/links/link_batch.h"
#include "light/solution/final_gather.h"
#include "light/solution/light_direct.h"
#include "light/solution/light_ranges.h"
#include "light/solution/light_records.h"
#include "light/solution/light_state.h"
#include "light/solution/light_steps.h"

#include <string.h>

// The units of one round of casting.
typedef struct cast_stage {
  olx_scene_light *light;
  uint32_t round;
  bool settled;               // later steps hold everything that its rays found, except links
  olx_link_batch part;        // surfels of the latest unit, with their links
  uint64_t rays;              // rays that it cast
  olx_point_list found;       // its ray ends without a surfel
  bool owns_links;            // whether `part` owns its links
  olx_kept_rays kept;         // of the latest unit
  olx_former_rays former;     // rays of the round for another scene
  olx_former_surfels earlier; // surfels of that scene
} cast_stage;

// A part of a batch.
typedef struct batch_part {
  olx_link_batch *batch;
  uint32_t first, count;
} batch_part;

static uint32_t surfels_a_unit(const olx_link_batch *batch) {
  return batch->rays < OLX_LIGHT_UNIT_RAYS ? OLX_LIGHT_UNIT_RAYS / batch->rays : 1;
}

static uint32_t units_of(const olx_link_batch *batch) {
  const uint32_t part = surfels_a_unit(batch);
  return (batch->count + part - 1) / part;
}

static batch_part part_of(const cast_stage *c, uint32_t unit) {
  olx_scene_light *l = c->light;
  for (uint32_t k = 0; k < l->links.batch_count; k++) {
    olx_link_batch *batch = &l->batches[k];
    if (l->rounds_of[k] != c->round) continue;
    if (unit < units_of(batch)) {
      const uint32_t part = surfels_a_unit(batch), first = unit * part, left = batch->count - first;
      return (batch_part){batch, first, left < part ? left : part};
    }
    unit -= units_of(batch);
  }
  return (batch_part){0};
}

static bool lists_unserved(uint32_t round) { return round < OLX_LIGHT_HIDDEN_ROUNDS; }

static olx_result allocate_links(olx_link_batch *batch) { return olx_link_batch_allocate(batch, !batch->guide); }

static void release_part(cast_stage *c) {
  if (c->owns_links) olx_link_batch_release(&c->part);
  else olx_link_batch_rest(&c->part, 0, c->part.count);
  olx_release(c->found.points);
  olx_kept_rays_free(&c->kept);
  c->owns_links = false;
  c->found = (olx_point_list){0};
}

// Writes the unit's links to the batch where it has room for them, otherwise to separate memory.
static olx_result begin_part(cast_stage *c, const batch_part *p) {
  const size_t offset = (size_t)p->first * p->batch->rays;
  release_part(c);
  c->part = *p->batch;
  c->part.count = p->count;
  c->rays = 0;
  if (p->batch->surfels) c->part.surfels += p->first;
  else c->part.first_surfel += p->first;
  c->owns_links = !p->batch->links;
  if (c->owns_links) return allocate_links(&c->part);
  c->part.links += offset;
  if (c->part.fixed) c->part.fixed += offset;
  return OLX_OK;
}

static olx_result append_points(olx_point_list *list, const olx_surfel_point *points, uint32_t count) {
  if (count == 0) return OLX_OK;
  if (list->count + count > list->capacity) {
    const uint32_t capacity = list->count + count > 2 * list->capacity ? list->count + count : 2 * list->capacity;
    olx_surfel_point *larger = olx_allocate(capacity, sizeof *larger);
    if (!larger) return olx_fail(OLX_ERROR_MEMORY, "light: out of memory for %u points of surfaces", capacity);
    if (list->count > 0) memcpy(larger, list->points, list->count * sizeof *larger);
    olx_release(list->points);
    list->points = larger;
    list->capacity = capacity;
  }
  memcpy(list->points + list->count, points, count * sizeof *points);
  list->count += count;
  return OLX_OK;
}

static olx_result cast_unit(void *user, uint32_t unit) {
  cast_stage *c = user;
  olx_scene_light *l = c->light;
  const batch_part p = part_of(c, unit);
  OLX_TRY(begin_part(c, &p));
  if (l->settings.keep_rays) OLX_TRY(olx_kept_rays_create(&c->kept, &c->part));
  const olx_cast_keeping keeping = {l->settings.keep_rays ? &c->kept : NULL, &c->former, &l->reused_rays};
  OLX_TRY(olx_links_cast(&l->surfels, &c->part, l->links.fixed, lists_unserved(c->round) ? &c->found : NULL, &keeping,
                         &c->rays));
  if (olx_unit_store_is_part(l->settings.store)) return OLX_OK; // whoever settles the round loads all of its units
  l->report.rays += c->rays;
  return append_points(&l->unserved, c->found.points, c->found.count);
}

static void save_cast(void *user, uint32_t unit, olx_byte_writer *to) {
  (void)unit;
  const cast_stage *c = user;
  const size_t links = (size_t)c->part.count * c->part.rays;
  olx_kept_rays_save(&c->kept, &c->part, &c->former.inputs, to);
  olx_bytes_put(to, &c->rays, 1, sizeof c->rays);
  olx_bytes_put(to, c->part.links, links, sizeof *c->part.links);
  if (c->part.fixed) olx_bytes_put(to, c->part.fixed, links, sizeof *c->part.fixed);
  for (uint32_t n = 0; n < c->part.count; n++) {
    olx_bytes_put(to, &c->light->links.fixed[olx_link_surfel(&c->part, n)], 1, sizeof *c->light->links.fixed);
  }
  olx_bytes_put(to, &c->found.count, 1, sizeof c->found.count);
  olx_bytes_put(to, c->found.points, c->found.count, sizeof *c->found.points);
}

// Loads what the rays of a unit found besides links.
static olx_result load_found(cast_stage *c, const batch_part *p, uint64_t rays, olx_byte_reader *from) {
  olx_scene_light *l = c->light;
  uint32_t count = 0;
  for (uint32_t n = 0; n < p->count; n++) {
    olx_fixed_light fixed = {0};
    olx_bytes_copy(from, &fixed, 1, sizeof fixed);
    const uint32_t surfel = p->batch->surfels ? p->batch->surfels[p->first + n] : p->batch->first_surfel + p->first + n;
    if (!c->settled) l->links.fixed[surfel] = fixed;
  }
  olx_bytes_copy(from, &count, 1, sizeof count);
  const olx_surfel_point *points = olx_bytes_get(from, count, sizeof *points);
  if (c->settled || !points) return OLX_OK;
  l->report.rays += rays;
  return append_points(&l->unserved, points, count);
}

static olx_result load_cast(void *user, uint32_t unit, olx_byte_reader *from) {
  cast_stage *c = user;
  const batch_part p = part_of(c, unit);
  const size_t offset = (size_t)p.first * p.batch->rays, links = (size_t)p.count * p.batch->rays;
  uint64_t rays = 0;
  olx_kept_rays_skip(from);
  olx_bytes_copy(from, &rays, 1, sizeof rays);
  olx_bytes_copy(from, p.batch->links + offset, links, sizeof *p.batch->links);
  if (!p.batch->guide) olx_bytes_copy(from, p.batch->fixed + offset, links, sizeof *p.batch->fixed);
  olx_link_batch_rest(p.batch, p.first, p.first + p.count);
  return load_found(c, &p, rays, from);
}

static olx_unit_stage stage_of(cast_stage *c) {
  olx_unit_stage stage = {"cast", c->round, 0, c, cast_unit, save_cast, load_cast, OLX_PARTS_ALL};
  for (uint32_t k = 0; k < c->light->links.batch_count; k++) {
    if (c->light->rounds_of[k] == c->round) stage.count += units_of(&c->light->batches[k]);
  }
  return stage;
}

// Allocates room for all links of a round, for callers that need them all.
static olx_result make_room(olx_scene_light *l, uint32_t round) {
  for (uint32_t k = 0; k < l->links.batch_count; k++) {
    if (l->rounds_of[k] == round && !l->batches[k].links) OLX_TRY(allocate_links(&l->batches[k]));
  }
  return OLX_OK;
}

// Casts the batches of the round, each as one piece, without a store.
static olx_result cast_whole(olx_scene_light *l) {
  for (uint32_t k = 0; k < l->links.batch_count; k++) {
    if (l->rounds_of[k] != l->round) continue;
    olx_point_list *unserved = lists_unserved(l->round) ? &l->unserved : NULL;
    OLX_TRY(olx_links_cast(&l->surfels, &l->batches[k], l->links.fixed, unserved, NULL, &l->report.rays));
  }
  return OLX_OK;
}

static void save_surfels_of(void *user, uint32_t unit, olx_byte_writer *to) {
  (void)unit;
  const cast_stage *c = user;
  olx_surfels_remember(&c->light->surfels, &c->former.inputs, to);
}

// The surfels that the rays of a round may end at. Only bakes of edited scenes read them.
static olx_unit_stage surfels_of(cast_stage *c) {
  return (olx_unit_stage){"surfels", c->round, 1, c, NULL, save_surfels_of, NULL, OLX_PARTS_ALL};
}

// Reads the rays of the round that were cast for another scene.
static olx_result read_former(cast_stage *c, const olx_unit_stage *stage) {
  olx_scene_light *l = c->light;
  void *data;
  size_t size_bytes;
  if (!l->settings.keep_rays) return OLX_OK;
  const olx_unit_stage surfels = surfels_of(c);
  c->former = (olx_former_rays){.now = &l->surfels, .surfels = &c->earlier};
  c->former.inputs = olx_surfels_inputs(&l->surfels, olx_surfels_hash(&l->surfels), &l->settings.inputs);
  olx_units_read_stale(l->settings.store, &surfels, 0, &data, &size_bytes);
  if (data) {
    olx_byte_reader reader = {.data = data, .size_bytes = size_bytes};
    const olx_result result = olx_former_surfels_read(&c->earlier, &reader, &l->surfels, &c->former.inputs);
    olx_release(data);
    OLX_TRY(result);
  }
  for (uint32_t unit = 0; olx_units_read_stale(l->settings.store, stage, unit, &data, &size_bytes); unit++) {
    if (data) OLX_TRY(olx_former_rays_add(&c->former, data, size_bytes));
  }
  return OLX_OK;
}

static olx_result cast_round(olx_scene_light *l) {
  olx_unit_store *store = l->settings.store;
  cast_stage c = {.light = l, .round = l->round};
  if (!olx_unit_store_is_part(store)) OLX_TRY(make_room(l, l->round));
  if (!store) return cast_whole(l);
  const olx_unit_stage stage = stage_of(&c), surfels = surfels_of(&c);
  olx_result result = read_former(&c, &stage);
  if (result == OLX_OK) result = olx_units_make(store, &stage);
  // The earlier surfels make way last, so that an interrupted round goes on with them.
  if (result == OLX_OK && l->settings.keep_rays) result = olx_unit_keep(store, &surfels);
  release_part(&c);
  olx_former_rays_free(&c.former);
  olx_former_surfels_free(&c.earlier);
  return result == OLX_ERROR_INCOMPLETE ? olx_units_await(store, &stage) : result;
}

// ---- Points: most of the data, and rarely read

typedef struct point_stage {
  olx_scene_light *light;
  uint32_t round;
} point_stage;

// Returns the parts of the scene that the result of a step depends on. The first one is where the surfaces are that
// probes see, and the distances between them. Buried probes see none, and views decide which probes are buried.
static olx_scene_parts parts_of_step(uint32_t step) {
  return step == 0 ? OLX_PART_GEOMETRY | OLX_PART_VIEWS : OLX_PARTS_ALL;
}

static uint32_t first_point(const point_stage *p) { return p->round ? p->light->point_ends[p->round - 1] : 0; }

static void save_points(void *user, uint32_t unit, olx_byte_writer *to) {
  (void)unit;
  const point_stage *p = user;
  const olx_light_surfels *s = &p->light->surfels;
  const uint32_t first = first_point(p);
  olx_bytes_put(to, s->points + first, p->light->point_ends[p->round] - first, sizeof *s->points);
}

static olx_result load_points(void *user, uint32_t unit, olx_byte_reader *from) {
  (void)unit;
  const point_stage *p = user;
  olx_light_surfels *s = &p->light->surfels;
  const uint32_t first = first_point(p);
  olx_bytes_copy(from, s->points + first, p->light->point_ends[p->round] - first, sizeof *s->points);
  return OLX_OK;
}

static olx_unit_stage points_of(point_stage *p) {
  return (olx_unit_stage){"points", p->round, 1, p, NULL, save_points, load_points, parts_of_step(p->round)};
}

// Stores the surface points that the last exploring step added.
static olx_result keep_points(olx_scene_light *l) {
  point_stage p = {l, l->round};
  const olx_unit_stage stage = points_of(&p);
  if (l->phase != OLX_LIGHT_EXPLORING) return OLX_OK; // no surfels were added
  return olx_unit_keep(l->settings.store, &stage);
}

static olx_result load_all_points(olx_scene_light *l) {
  for (uint32_t round = 0; round <= OLX_LIGHT_HIDDEN_ROUNDS; round++) {
    point_stage p = {l, round};
    const olx_unit_stage stage = points_of(&p);
    if (l->point_ends[round] > first_point(&p)) OLX_TRY(olx_units_load(l->settings.store, &stage));
  }
  return OLX_OK;
}

// Loads the points. Without them the solution cannot continue, so that all steps are discarded.
static olx_result need_points(olx_scene_light *l) {
  olx_light_surfels *s = &l->surfels;
  if (s->points || s->point_count == 0) return OLX_OK;
  s->points = olx_allocate(s->point_count, sizeof *s->points);
  if (!s->points) return olx_fail(OLX_ERROR_MEMORY, "light: out of memory for %u points of surfaces", s->point_count);
  const olx_result result = load_all_points(l);
  if (result == OLX_OK) return OLX_OK;
  olx_release(s->points);
  s->points = NULL;
  if (result == OLX_ERROR_INCOMPLETE) olx_units_forget(l->settings.store, "light", 0, OLX_LIGHT_MOST_STEPS + 1);
  return result;
}

// ---- The lookup of records

static void save_lookup(void *user, uint32_t unit, olx_byte_writer *to) {
  (void)unit;
  const olx_surfel_lookup *lookup = &((const olx_scene_light *)user)->records.lookup;
  const uint32_t numbers[] = {lookup->levels, lookup->list_words};
  olx_bytes_put(to, numbers, 2, sizeof *numbers);
  olx_bytes_put(to, lookup->lists, lookup->list_words, sizeof *lookup->lists);
  olx_cell_table_save(&lookup->cubes, to);
}

static olx_result load_lookup(void *user, uint32_t unit, olx_byte_reader *from) {
  (void)unit;
  olx_light_records *r = &((olx_scene_light *)user)->records;
  uint32_t numbers[2] = {0};
  olx_surfel_lookup_free(&r->lookup);
  olx_bytes_copy(from, numbers, 2, sizeof *numbers);
  r->lookup = (olx_surfel_lookup){.surfels = &r->places, .levels = numbers[0], .list_words = numbers[1]};
  r->lookup.lists = olx_bytes_take(from, numbers[1], sizeof *r->lookup.lists);
  olx_cell_table_load(&r->lookup.cubes, from);
  return OLX_OK;
}

olx_result olx_light_units_look_up(olx_scene_light *l) {
  const olx_unit_stage stage = {"lookup", 0, 1, l, NULL, save_lookup, load_lookup, OLX_PARTS_ALL};
  if (olx_units_have(l->settings.store, &stage)) {
    const olx_result result = olx_units_load(l->settings.store, &stage);
    if (result != OLX_ERROR_INCOMPLETE) return result;
  }
  OLX_TRY(olx_light_records_look_up(l)); // the lookup is not stored, or damaged
  return olx_unit_keep(l->settings.store, &stage);
}

// ---- Loading links

static void apply_patch(olx_scene_light *l, uint32_t round) {
  const olx_link_patch *patch = &l->patches[round];
  for (uint32_t k = 0; k < l->links.batch_count; k++) {
    olx_link_batch *batch = &l->batches[k];
    if (l->rounds_of[k] != round) continue;
    uint32_t next = 0, from = 0;
    for (size_t i = 0; i < (size_t)batch->count * batch->rays && next < patch->count; i++) {
      if (i % batch->rays == 0 && i > 0) olx_link_batch_passed(batch, (uint32_t)(i / batch->rays) - 1, &from);
      if (olx_link_end(&batch->links[i]) != OLX_LINK_UNSERVED) continue;
      batch->links[i] = patch->links[next];
      batch->fixed[i] = patch->fixed[next++];
    }
    olx_link_batch_rest(batch, 0, batch->count);
  }
}

// Frees the light that rays brought without links, which is not needed once a guide has learnt from it.
static void drop_fixed(olx_scene_light *l, uint32_t round) {
  for (uint32_t k = 0; l->guide.pools && k < l->links.batch_count; k++) {
    if (l->rounds_of[k] == round) olx_link_batch_release_fixed(&l->batches[k]);
  }
}

static bool has_links(const olx_scene_light *l, uint32_t round) {
  for (uint32_t k = 0; k < l->links.batch_count; k++) {
    if (l->rounds_of[k] == round && !l->batches[k].links) return false;
  }
  return true;
}

static void drop_links(olx_scene_light *l, uint32_t round) {
  for (uint32_t k = 0; k < l->links.batch_count; k++) {
    if (l->rounds_of[k] == round) olx_link_batch_release(&l->batches[k]);
  }
}

// Loads the links of a round. Units of a settled round cannot be recomputed from the current state: when one is
// damaged, the steps after the round are discarded.
static olx_result load_round(olx_scene_light *l, uint32_t round, bool settled) {
  cast_stage c = {.light = l, .round = round, .settled = settled};
  if (has_links(l, round)) return OLX_OK;
  OLX_TRY(make_room(l, round));
  const olx_unit_stage stage = stage_of(&c);
  const olx_result result = olx_units_load(l->settings.store, &stage);
  if (result == OLX_OK && settled && round < OLX_LIGHT_HIDDEN_ROUNDS) apply_patch(l, round);
  if (result == OLX_ERROR_INCOMPLETE && settled) olx_units_forget(l->settings.store, "light", 1, OLX_LIGHT_MOST_STEPS);
  if (result == OLX_OK) drop_fixed(l, round);
  else drop_links(l, round);
  return result;
}

// Loads what settling the current phase needs: direct light and refining need the links of every round, exploring only
// those of the last, and gathering and dividing none. Exploring adds points, and those of visible surfels tell how
// cells may be divided.
static olx_result load_for_settling(olx_scene_light *l) {
  OLX_TRY(need_points(l));
  if (l->phase == OLX_LIGHT_EXPLORING) return load_round(l, l->round, false);
  if (l->phase == OLX_LIGHT_GATHERING) return olx_light_ranges_load(l, &olx_final_ranges);
  if (l->phase == OLX_LIGHT_DIVIDING) return olx_light_ranges_load(l, &olx_record_ranges);
  for (uint32_t round = 0; round < l->round; round++) OLX_TRY(load_round(l, round, true));
  if (l->phase == OLX_LIGHT_REFINING) return load_round(l, l->round, false);
  return olx_light_ranges_load(l, &olx_direct_ranges);
}

olx_result olx_light_units_load_links(olx_scene_light *l) {
  OLX_TRY(need_points(l));
  for (uint32_t round = 0; round <= l->round; round++) OLX_TRY(load_round(l, round, true));
  return OLX_OK;
}

// ---- Steps

static void save_step(void *user, uint32_t unit, olx_byte_writer *to) {
  (void)unit;
  olx_light_state_save(user, to);
}

static olx_result load_step(void *user, uint32_t unit, olx_byte_reader *from) {
  (void)unit;
  return olx_light_state_load(user, from);
}

static olx_result make_first(void *user, uint32_t unit) {
  (void)unit;
  olx_scene_light *l = user;
  OLX_TRY(olx_scene_light_begin(l));
  for (uint32_t round = 0; round <= OLX_LIGHT_HIDDEN_ROUNDS; round++) l->point_ends[round] = l->surfels.point_count;
  return keep_points(l);
}

static olx_result make_next(void *user, uint32_t unit) {
  (void)unit;
  olx_scene_light *l = user;
  if (l->settings.store) OLX_TRY(load_for_settling(l));
  const bool explored = l->phase == OLX_LIGHT_EXPLORING;
  OLX_TRY(olx_scene_light_settle(l));
  if (!explored) return OLX_OK;
  for (uint32_t round = l->round; round <= OLX_LIGHT_HIDDEN_ROUNDS; round++)
    l->point_ends[round] = l->surfels.point_count;
  return keep_points(l);
}

static olx_unit_stage step_of(olx_scene_light *l, uint32_t step) {
  return (olx_unit_stage){
      "light", step, 1, l, step == 0 ? make_first : make_next, save_step, load_step, parts_of_step(step)};
}

// Returns the last stored step; 0 when there is none.
static uint32_t last_stored(olx_scene_light *l) {
  for (uint32_t step = OLX_LIGHT_MOST_STEPS; step > 0; step--) {
    const olx_unit_stage stage = step_of(l, step);
    if (olx_units_have(l->settings.store, &stage)) return step;
  }
  return 0;
}

// Loads the last stored step that is undamaged, or computes the first.
static olx_result resume(olx_scene_light *l, uint32_t *step) {
  olx_unit_store *store = l->settings.store;
  for (*step = last_stored(l); *step > 0; *step = last_stored(l)) {
    const olx_unit_stage stage = step_of(l, *step);
    const olx_result result = olx_units_load(store, &stage);
    if (result != OLX_ERROR_INCOMPLETE) return result;
    if (olx_units_have(store, &stage)) {
      return olx_fail(OLX_ERROR_FILE, "light: the result of step %u is damaged and cannot be removed", *step);
    }
  }
  const olx_unit_stage first = step_of(l, 0);
  return olx_unit_once(store, &first);
}

// Casts the rays that the next step needs.
static olx_result cast_for_step(olx_scene_light *l) {
  if (l->phase == OLX_LIGHT_GATHERING) return olx_light_ranges_fill(l, &olx_final_ranges);
  if (l->phase == OLX_LIGHT_DIVIDING) return olx_light_ranges_fill(l, &olx_record_ranges);
  if (l->phase != OLX_LIGHT_DIRECT) return cast_round(l);
  OLX_TRY(need_points(l));
  return olx_light_ranges_fill(l, &olx_direct_ranges);
}

static olx_result run_steps(olx_scene_light *l) {
  olx_unit_store *store = l->settings.store;
  uint32_t step;
  OLX_TRY(resume(l, &step));
  while (l->phase != OLX_LIGHT_FINISHED) {
    const olx_unit_stage next = step_of(l, ++step);
    if (!olx_units_have(store, &next)) OLX_TRY(cast_for_step(l));
    OLX_TRY(olx_unit_once(store, &next));
  }
  return OLX_OK;
}

olx_result olx_light_units_explore(olx_scene_light *l) {
  OLX_TRY(olx_scene_light_begin(l));
  while (l->phase == OLX_LIGHT_EXPLORING) {
    OLX_TRY(cast_round(l));
    OLX_TRY(olx_scene_light_settle(l));
  }
  return OLX_OK;
}

// No part can go on while a step is incomplete, so that those with nothing to add need not load the steps before it.
static olx_result run_steps_in_part(olx_scene_light *l) {
  OLX_TRY(olx_units_heed_mark(l->settings.store));
  const olx_result result = run_steps(l);
  if (result == OLX_ERROR_INCOMPLETE) OLX_TRY(olx_units_leave_mark(l->settings.store));
  return result;
}

olx_result olx_light_units_run(olx_scene_light *l) {
  if (olx_unit_store_is_part(l->settings.store)) return run_steps_in_part(l);
  const olx_result result = run_steps(l);
  if (result != OLX_ERROR_INCOMPLETE) return result;
  // Damaged links were discarded with the steps after them; a whole bake recomputes these at once.
  olx_scene_light_clear(l);
  return run_steps(l);
}
