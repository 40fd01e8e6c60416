// Compares the surfels and the geometry of an earlier scene with those of a bake.
#include "light/links/former_surfels.h"

#include "core/chunk_file.h"
#include "core/hooks.h"
#include "core/result.h"

#include <string.h>

// A surfel, without the padding of its struct and without the range of its points.
typedef struct surfel_numbers {
  uint64_t cell;
  olx_vec3 position, normal;
  float side, nearest;
  uint32_t next, triangle, back_face;
  float u, v;
  uint32_t marks; // olx_surfel_marks
} surfel_numbers;

_Static_assert(sizeof(surfel_numbers) == 64, "no padding that the hash would see");

static surfel_numbers numbers_of(const olx_light_surfels *s, uint32_t surfel) {
  const olx_light_surfel *f = &s->surfels[surfel];
  return (surfel_numbers){.cell = f->cell,
                          .position = f->position,
                          .normal = f->normal,
                          .side = f->side,
                          .nearest = f->nearest,
                          .next = f->next,
                          .triangle = f->point.triangle,
                          .back_face = f->point.back_face,
                          .u = f->point.u,
                          .v = f->point.v,
                          .marks = olx_surfel_marks(s, surfel)};
}

uint64_t olx_surfels_hash(const olx_light_surfels *s) {
  uint64_t hash[3] = {s->count};
  for (uint32_t i = 0; i < s->count; i++) {
    const surfel_numbers numbers = numbers_of(s, i);
    hash[1] = olx_content_hash(&numbers, sizeof numbers);
    hash[0] = olx_content_hash(hash, sizeof hash);
  }
  for (uint32_t i = 0; i < s->table.capacity; i++) {
    if (s->table.keys[i] == 0) continue;
    hash[1] = s->table.keys[i];
    hash[2] = s->table.values[i];
    hash[0] = olx_content_hash(hash, sizeof hash);
  }
  return hash[0];
}

olx_scene_inputs olx_surfels_inputs(const olx_light_surfels *s, uint64_t surfels_hash, const olx_scene_inputs *scene) {
  olx_scene_inputs inputs = *scene;
  const olx_near_lamps *lamps = &s->lamps;
  inputs.slots[OLX_INPUT_SURFELS] = surfels_hash;
  if (!lamps->radius) return inputs;
  uint64_t hash[4] = {inputs.slots[OLX_INPUT_LIGHTS]};
  hash[1] = olx_content_hash(lamps->radius, s->scene->light_count * sizeof *lamps->radius);
  hash[2] = olx_content_hash(lamps->points, lamps->count * sizeof *lamps->points);
  hash[3] = olx_content_hash(lamps->sums, lamps->count * sizeof *lamps->sums);
  inputs.slots[OLX_INPUT_LIGHTS] = inputs.slots[OLX_INPUT_NEAR_LAMPS] = olx_content_hash(hash, sizeof hash);
  return inputs;
}

// ---- Saving

typedef struct surfels_record {
  olx_scene_inputs inputs;
  uint64_t count, slots; // surfels, and slots of the table
} surfels_record;

void olx_surfels_remember(const olx_light_surfels *s, const olx_scene_inputs *inputs, olx_byte_writer *to) {
  const surfels_record record = {*inputs, s->count, s->table.capacity};
  olx_bytes_put(to, &record, 1, sizeof record);
  for (uint32_t i = 0; i < s->count; i++) {
    const surfel_numbers numbers = numbers_of(s, i);
    olx_bytes_put(to, &numbers, 1, sizeof numbers);
  }
  olx_bytes_put(to, s->table.keys, s->table.capacity, sizeof *s->table.keys);
  olx_bytes_put(to, s->table.values, s->table.capacity, sizeof *s->table.values);
}

// ---- Comparing

// Earlier surfels beside those of the bake.
typedef struct surfel_pair {
  const surfel_numbers *before;
  uint32_t count;
  const olx_light_surfels *now;
} surfel_pair;

// Returns whether two surfels cast the same rays, their geometry apart.
static bool casts_same(const surfel_numbers *a, const surfel_numbers *b) {
  return a->cell == b->cell && a->triangle == b->triangle && a->back_face == b->back_face && a->u == b->u &&
         a->v == b->v && memcmp(&a->position, &b->position, sizeof a->position) == 0 &&
         memcmp(&a->normal, &b->normal, sizeof a->normal) == 0;
}

// Returns whether two surfels cast the same rays, see the same surfaces close to them, and have the same marks, so that
// the same rays that end at them find direct light themselves.
static bool is_same(const surfel_pair *p, uint32_t before, uint32_t now) {
  const surfel_numbers a = p->before[before], b = numbers_of(p->now, now);
  return casts_same(&a, &b) && a.side == b.side && a.nearest == b.nearest && a.marks == b.marks;
}

// Returns the earlier surfel after another of its cell; OLX_CELL_NONE after the last one.
static uint32_t next_before(const surfel_pair *p, uint32_t before) {
  const uint32_t next = p->before[before].next;
  return next > before && next < p->count ? next : OLX_CELL_NONE;
}

// Returns the surfel of the bake that casts the rays of an earlier one, or OLX_CELL_NONE.
static uint32_t find_now(const surfel_pair *p, uint32_t before) {
  const uint32_t value = olx_cell_table_get(&p->now->table, p->before[before].cell);
  if (value == OLX_CELL_NONE) return OLX_CELL_NONE;
  for (uint32_t i = value & ~OLX_CELL_DIVIDED; i != OLX_CELL_NONE; i = p->now->surfels[i].next) {
    const surfel_numbers numbers = numbers_of(p->now, i);
    if (casts_same(&p->before[before], &numbers)) return i;
  }
  return OLX_CELL_NONE;
}

// Returns the eighths of a cell that are known, one bit each.
static uint32_t known_eighths(const olx_cell_table *table, uint64_t cell) {
  const uint64_t bin = cell & ((1u << OLX_CELL_BIN_BITS) - 1);
  uint32_t known = 0;
  for (uint32_t i = 0; i < 8; i++) {
    const uint64_t eighth = ((cell >> OLX_CELL_BIN_BITS) << 3 | i) << OLX_CELL_BIN_BITS | bin;
    known |= (uint32_t)(olx_cell_table_get(table, eighth) != OLX_CELL_NONE) << i;
  }
  return known;
}

// Returns whether every look-up that ends at a cell ends there with the same surfels now.
static bool cell_is_same(const surfel_pair *p, const olx_cell_table *table, uint64_t cell, uint32_t value) {
  const uint32_t now = olx_cell_table_get(&p->now->table, cell);
  if (now == OLX_CELL_NONE || (now ^ value) & OLX_CELL_DIVIDED) return false;
  uint32_t a = value & ~OLX_CELL_DIVIDED, b = now & ~OLX_CELL_DIVIDED;
  while (a != OLX_CELL_NONE && b != OLX_CELL_NONE) {
    if (!is_same(p, a, b)) return false;
    a = next_before(p, a);
    b = p->now->surfels[b].next;
  }
  return a == b && known_eighths(table, cell) == known_eighths(&p->now->table, cell);
}

// Enters the surfels of a cell, unless it or another cell that leads to them has changed.
static void serve(olx_former_surfels *former, const surfel_pair *p, uint64_t cell, uint32_t first, bool same,
                  bool *changed) {
  uint32_t now = olx_cell_table_get(&p->now->table, cell) & ~OLX_CELL_DIVIDED;
  for (uint32_t i = first; i != OLX_CELL_NONE; i = next_before(p, i)) {
    uint32_t *served_by = &former->served_by[i];
    changed[i] |= !same || (*served_by != OLX_CELL_NONE && *served_by != now);
    *served_by = changed[i] ? OLX_CELL_NONE : now;
    if (same) now = p->now->surfels[now].next;
  }
}

static olx_result compare(olx_former_surfels *former, const surfel_pair *p) {
  const olx_cell_table *table = &former->table;
  former->count = p->count;
  former->now = olx_allocate(p->count, sizeof *former->now);
  former->served_by = olx_allocate(p->count, sizeof *former->served_by);
  bool *changed = olx_allocate_zero(p->count, sizeof *changed);
  olx_result result = former->now && former->served_by && changed ? olx_cell_table_create(&former->same, table->count)
                                                                  : OLX_ERROR_MEMORY;
  for (uint32_t i = 0; result == OLX_OK && i < p->count; i++) {
    former->now[i] = find_now(p, i);
    former->served_by[i] = OLX_CELL_NONE;
  }
  for (uint32_t i = 0; result == OLX_OK && i < table->capacity; i++) {
    const uint32_t first = table->values[i] & ~OLX_CELL_DIVIDED;
    if (table->keys[i] == 0 || first >= p->count) continue;
    const bool same = cell_is_same(p, table, table->keys[i], table->values[i]);
    serve(former, p, table->keys[i], first, same, changed);
    if (same) result = olx_cell_table_set(&former->same, table->keys[i], 0);
  }
  olx_release(changed);
  return result == OLX_OK ? OLX_OK : olx_fail(OLX_ERROR_MEMORY, "light: out of memory for surfels of another scene");
}

static void compare_bricks(olx_former_surfels *former, const olx_scene_inputs *before, const olx_scene_inputs *now) {
  for (uint32_t i = 0; i < OLX_SPACE_BRICKS; i++) {
    former->changed.words[i / 64] |= (uint64_t)(before->bricks[i] != now->bricks[i]) << i % 64;
  }
}

static bool has_bounds_of(const olx_scene_inputs *a, const olx_scene_inputs *b) {
  return memcmp(a->origin, b->origin, sizeof a->origin) == 0 && memcmp(&a->low, &b->low, sizeof a->low) == 0 &&
         memcmp(&a->high, &b->high, sizeof a->high) == 0;
}

// Counts the cells of a table that was read. Returns whether it can be searched: its size is a power of two, and a slot
// is free.
static bool count_cells(olx_cell_table *table, uint64_t slots) {
  if (slots == 0 || slots > UINT32_MAX || (slots & (slots - 1)) != 0) return false;
  table->capacity = (uint32_t)slots;
  table->count = 0;
  for (uint32_t i = 0; i < table->capacity; i++) table->count += table->keys[i] != 0;
  return table->count < table->capacity;
}

olx_result olx_former_surfels_read(olx_former_surfels *former, olx_byte_reader *from, const olx_light_surfels *now,
                                   const olx_scene_inputs *inputs) {
  *former = (olx_former_surfels){0};
  const surfels_record *record = olx_bytes_get(from, 1, sizeof *record);
  if (!record || !has_bounds_of(&record->inputs, inputs)) return OLX_OK;
  surfel_pair p = {.count = (uint32_t)record->count, .now = now};
  p.before = olx_bytes_get(from, p.count, sizeof *p.before);
  former->table.keys = olx_bytes_take(from, record->slots, sizeof *former->table.keys);
  former->table.values = olx_bytes_take(from, record->slots, sizeof *former->table.values);
  olx_result result = OLX_OK;
  if (!from->failed && count_cells(&former->table, record->slots)) {
    former->name = olx_surfels_name_of(&record->inputs);
    compare_bricks(former, &record->inputs, inputs);
    result = compare(former, &p);
  }
  if (result != OLX_OK || former->count == 0) olx_former_surfels_free(former);
  return result;
}

void olx_former_surfels_free(olx_former_surfels *former) {
  olx_release(former->now);
  olx_release(former->served_by);
  olx_cell_table_free(&former->table);
  olx_cell_table_free(&former->same);
  *former = (olx_former_surfels){0};
}

// Returns whether rays that found no surfel at a place find none now.
static bool is_still_unserved(const olx_former_surfels *former, const olx_light_surfels *now, uint64_t finest_key) {
  const uint64_t cell = olx_light_surfels_cell(&former->table, finest_key);
  if (cell == 0) return olx_light_surfels_cell(&now->table, finest_key) == 0;
  return olx_cell_table_get(&former->same, cell) != OLX_CELL_NONE;
}

bool olx_link_still_ends(olx_link *link, const olx_surfel_point *point, const olx_former_surfels *former,
                         const olx_light_surfels *now) {
  const uint32_t end = olx_link_end(link);
  if (end == OLX_LINK_NOWHERE) return true;
  if (!former) return end == OLX_LINK_UNSERVED || end < now->count;
  if (end == OLX_LINK_UNSERVED) return is_still_unserved(former, now, point->key);
  if (end >= former->count || former->served_by[end] == OLX_CELL_NONE) return false;
  link->end = (link->end & ~OLX_LINK_NOWHERE) | former->served_by[end];
  return true;
}
