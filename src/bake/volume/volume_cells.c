// Divides free space into cubic cells, small near surfaces and smaller where those would not see their probes, gives
// the sides of each cell their probes, and writes it all into the structure that a field holds.
#include "bake/volume/volume_cells.h"

#include "bake/volume/volume_sight.h"
#include "core/hooks.h"
#include "core/result.h"
#include "light/surfels/surface_cells.h"
#include "scene/bvh.h"

enum {
  CELLS_PER_JOB = 16,
  PARTS = 1 << OLX_VOLUME_LEVELS,
  NEAR_LEVELS = OLX_VOLUME_LEVELS - 1, // how often a cube is halved because surfaces are near
  NO_NEXT = -1
};

// A cell is halved when a surface is nearer to its middle than this share of its side: that is, when a surface is in
// the cell or close to it.
static const float NEAR = 1.0f;
// A place that replaces a corner may also serve another cell, when it is at most this many times as far from the corner
// as the cell's own place.
static const float SHARED_DISTANCE = 1.25f;

// A cell: its low corner in parts of cubes, and how often its cube was halved.
typedef struct leaf {
  uint32_t x, y, z, level;
} leaf;

typedef struct stand_in {
  uint32_t probe;
  int32_t next; // of the same corner
} stand_in;

typedef struct builder {
  const olx_volume_space *space;
  olx_volume_header header;
  float part; // metres: the side of the smallest cells
  uint32_t most_cells;
  leaf *leaves;
  uint32_t leaf_count, leaf_capacity;
  olx_volume_sides *sides; // of each leaf
  bool *blind;             // of each leaf: its probes cannot light it, and it may be halved
  olx_cell_table corners, chains;
  stand_in *stand_ins;
  uint32_t stand_in_count;
  olx_vec3 *positions; // of probes
  uint32_t *index, *blocks;
  uint32_t block_capacity;
  olx_volume_split *splits;
  olx_volume_cell *cells;
} builder;

static olx_result out_of_memory(void) { return olx_fail(OLX_ERROR_MEMORY, "bake: out of memory for the volume"); }

static olx_vec3 place_of(const builder *b, uint32_t x, uint32_t y, uint32_t z) {
  return olx_madd(olx_load3(b->header.origin), olx_v3((float)x, (float)y, (float)z), b->part);
}

static olx_result add_leaf(builder *b, leaf cell) {
  if (b->leaf_count == b->leaf_capacity) {
    const uint32_t capacity = b->leaf_capacity ? 2 * b->leaf_capacity : 1024;
    leaf *larger = olx_allocate(capacity, sizeof *larger);
    if (!larger) return out_of_memory();
    for (uint32_t i = 0; i < b->leaf_count; i++) larger[i] = b->leaves[i];
    olx_release(b->leaves);
    b->leaves = larger;
    b->leaf_capacity = capacity;
  }
  b->leaves[b->leaf_count++] = cell;
  return OLX_OK;
}

// Returns one of the eight cells that halving makes of one.
static leaf part_of(leaf cell, uint32_t i) {
  const uint32_t half = (PARTS >> cell.level) / 2;
  return (leaf){cell.x + half * (i & 1), cell.y + half * (i >> 1 & 1), cell.z + half * (i >> 2), cell.level + 1};
}

static olx_result divide(builder *b, leaf cell) {
  const uint32_t parts = PARTS >> cell.level;
  const float side = b->part * (float)parts;
  const olx_vec3 low = place_of(b, cell.x, cell.y, cell.z);
  if (b->leaf_count > b->most_cells) return OLX_OK; // too many; the caller begins anew
  if (!olx_volume_space_touches(b->space, low, olx_add(low, olx_splat(side)))) return OLX_OK;
  const olx_vec3 middle = olx_add(low, olx_splat(0.5f * side));
  if (cell.level == NEAR_LEVELS || olx_bvh_distance(b->space->scene->bvh, middle, NEAR * side) >= NEAR * side) {
    return add_leaf(b, cell);
  }
  for (uint32_t i = 0; i < 8; i++) OLX_TRY(divide(b, part_of(cell, i)));
  return OLX_OK;
}

static void lay_grid(builder *b) {
  const olx_box box = b->space->space.box;
  const float cube = b->part * PARTS;
  const float low[3] = {box.min.x, box.min.y, box.min.z}, high[3] = {box.max.x, box.max.y, box.max.z};
  b->header.cube_metres = cube;
  for (uint32_t axis = 0; axis < 3; axis++) {
    const float first = floorf(low[axis] / cube);
    b->header.origin[axis] = first * cube;
    b->header.size[axis] = (uint32_t)(floorf(high[axis] / cube) - first) + 1;
  }
}

static olx_result divide_space(builder *b) {
  lay_grid(b);
  b->leaf_count = 0;
  for (uint32_t z = 0; z < b->header.size[2]; z++) {
    for (uint32_t y = 0; y < b->header.size[1]; y++) {
      for (uint32_t x = 0; x < b->header.size[0]; x++) {
        OLX_TRY(divide(b, (leaf){x * PARTS, y * PARTS, z * PARTS, 0}));
      }
    }
  }
  return olx_check_cancelled();
}

static void find_sides(void *user, uint32_t job) {
  builder *b = user;
  const uint32_t end = (job + 1) * CELLS_PER_JOB < b->leaf_count ? (job + 1) * CELLS_PER_JOB : b->leaf_count;
  const float lift = b->header.cube_metres * OLX_VOLUME_LIFT;
  for (uint32_t i = job * CELLS_PER_JOB; i < end; i++) {
    const leaf *l = &b->leaves[i];
    const float side = b->part * (float)(PARTS >> l->level);
    const olx_vec3 low = place_of(b, l->x, l->y, l->z);
    olx_volume_sides_find(b->space, low, side, lift, &b->sides[i]);
    b->blind[i] = l->level == NEAR_LEVELS && olx_volume_is_blind(b->space, low, side, lift, &b->sides[i]);
  }
}

static olx_result find_all_sides(builder *b, uint32_t threads) {
  olx_release(b->sides);
  olx_release(b->blind);
  b->sides = olx_allocate(b->leaf_count, sizeof *b->sides);
  b->blind = olx_allocate(b->leaf_count, sizeof *b->blind);
  if (!b->sides || !b->blind) return out_of_memory();
  return olx_parallel_for((b->leaf_count + CELLS_PER_JOB - 1) / CELLS_PER_JOB, threads, find_sides, b, NULL, 0);
}

static olx_result add_parts(builder *b, leaf cell) {
  const float side = b->part * (float)(PARTS >> cell.level) * 0.5f;
  for (uint32_t i = 0; i < 8; i++) {
    const leaf part = part_of(cell, i);
    const olx_vec3 low = place_of(b, part.x, part.y, part.z), high = olx_add(low, olx_splat(side));
    if (olx_volume_space_touches(b->space, low, high)) OLX_TRY(add_leaf(b, part));
  }
  return OLX_OK;
}

static olx_result halve_all(builder *b, const leaf *before, uint32_t count) {
  b->leaf_count = b->leaf_capacity = 0;
  b->leaves = NULL;
  for (uint32_t i = 0; i < count; i++) {
    if (b->blind[i]) OLX_TRY(add_parts(b, before[i]));
    else OLX_TRY(add_leaf(b, before[i]));
  }
  return OLX_OK;
}

// Halves blind leaves, where that does not make too many.
static olx_result halve_blind(builder *b, uint32_t threads) {
  uint32_t blind = 0;
  for (uint32_t i = 0; i < b->leaf_count; i++) blind += b->blind[i];
  if (blind == 0 || b->leaf_count + 7 * blind > b->most_cells) return OLX_OK;
  leaf *before = b->leaves;
  const olx_result result = halve_all(b, before, b->leaf_count);
  olx_release(before);
  OLX_TRY(result);
  return find_all_sides(b, threads);
}

static olx_result allocate_structure(builder *b) {
  uint32_t sides = 0, splits = 0;
  for (uint32_t i = 0; i < b->leaf_count; i++) {
    sides += b->sides[i].side_count;
    splits += b->sides[i].split_count;
  }
  const size_t corners = (size_t)OLX_VOLUME_CORNERS * sides;
  b->cells = olx_allocate(sides, sizeof *b->cells);
  b->splits = olx_allocate(splits, sizeof *b->splits);
  b->positions = olx_allocate(corners, sizeof *b->positions);
  b->stand_ins = olx_allocate(corners, sizeof *b->stand_ins);
  b->index = olx_allocate_zero((size_t)b->header.size[0] * b->header.size[1] * b->header.size[2], sizeof *b->index);
  if (!b->cells || !b->splits || !b->positions || !b->stand_ins || !b->index) return out_of_memory();
  OLX_TRY(olx_cell_table_create(&b->corners, sides));
  return olx_cell_table_create(&b->chains, sides);
}

static uint64_t corner_key(const leaf *l, uint32_t corner) {
  const uint32_t parts = PARTS >> l->level;
  const uint64_t x = l->x + parts * (corner & 1), y = l->y + parts * (corner >> 1 & 1),
                 z = l->z + parts * (corner >> 2);
  return 1 + (x | y << 21 | z << 42);
}

static uint32_t add_probe(builder *b, olx_vec3 position) {
  b->positions[b->header.probes] = position;
  return b->header.probes++;
}

static olx_result corner_probe(builder *b, uint64_t key, olx_vec3 position, uint32_t *probe) {
  *probe = olx_cell_table_get(&b->corners, key);
  if (*probe != OLX_CELL_NONE) return OLX_OK;
  *probe = add_probe(b, position);
  return olx_cell_table_set(&b->corners, key, *probe);
}

// Finds a place that already replaces the same corner, when this side sees it and it is as near to the corner;
// otherwise makes a new one.
static olx_result stand_in_probe(builder *b, uint64_t key, olx_vec3 corner, olx_vec3 anchor, olx_vec3 position,
                                 uint32_t *probe) {
  const float reach = SHARED_DISTANCE * olx_length(olx_sub(position, corner));
  const uint32_t head = olx_cell_table_get(&b->chains, key);
  for (int32_t i = head == OLX_CELL_NONE ? NO_NEXT : (int32_t)head; i != NO_NEXT; i = b->stand_ins[i].next) {
    *probe = b->stand_ins[i].probe;
    const olx_vec3 found = b->positions[*probe];
    const olx_ray ray = {anchor, olx_sub(found, anchor), 0.0f, 1.0f};
    if (olx_length(olx_sub(found, corner)) <= reach && !olx_bvh_occluded(b->space->scene->bvh, &ray)) return OLX_OK;
  }
  *probe = add_probe(b, position);
  b->stand_ins[b->stand_in_count] = (stand_in){*probe, head == OLX_CELL_NONE ? NO_NEXT : (int32_t)head};
  return olx_cell_table_set(&b->chains, key, b->stand_in_count++);
}

static olx_result add_side(builder *b, const leaf *l, const olx_volume_side *side) {
  olx_volume_cell *cell = &b->cells[b->header.cells++];
  const olx_vec3 low = place_of(b, l->x, l->y, l->z);
  for (uint32_t i = 0; i < OLX_VOLUME_CORNERS; i++) {
    const uint64_t key = corner_key(l, i);
    const olx_vec3 corner = olx_volume_corner(low, b->part * (float)(PARTS >> l->level), i);
    const olx_result result = side->corners >> i & 1
                                  ? corner_probe(b, key, corner, &cell->probes[i])
                                  : stand_in_probe(b, key, corner, side->anchor, side->stand_ins[i], &cell->probes[i]);
    OLX_TRY(result);
  }
  return OLX_OK;
}

// Converts an entry from a leaf's own numbers to those of the whole structure.
static uint32_t global_entry(const leaf *l, uint32_t entry, uint32_t first_cell, uint32_t first_split) {
  const uint32_t number = entry & OLX_VOLUME_NUMBER;
  switch (entry & OLX_VOLUME_KIND) {
  case OLX_VOLUME_CELL: return OLX_VOLUME_CELL | l->level << OLX_VOLUME_LEVEL_SHIFT | (number + first_cell);
  case OLX_VOLUME_SPLIT: return OLX_VOLUME_SPLIT | (number + first_split);
  default: return 0;
  }
}

// Finds the block that an entry names. An entry that names nothing becomes a block.
static olx_result block_at(builder *b, uint32_t *entry, uint32_t *block) {
  if (*entry == 0) {
    if (b->header.blocks == b->block_capacity) {
      const uint32_t capacity = b->block_capacity ? 2 * b->block_capacity : 64;
      uint32_t *larger = olx_allocate_zero((size_t)capacity * OLX_VOLUME_BLOCK_ENTRIES, sizeof *larger);
      if (!larger) return out_of_memory();
      for (size_t i = 0; i < (size_t)b->header.blocks * OLX_VOLUME_BLOCK_ENTRIES; i++) larger[i] = b->blocks[i];
      olx_release(b->blocks);
      b->blocks = larger;
      b->block_capacity = capacity;
    }
    *entry = OLX_VOLUME_BLOCK | b->header.blocks++;
  }
  *block = *entry & OLX_VOLUME_NUMBER;
  return OLX_OK;
}

// A block has four entries along each side; a cell of half its side takes up eight of them.
static void fill_block(builder *b, uint32_t block, const leaf *l, uint32_t parts_an_entry, uint32_t entry) {
  const uint32_t parts = PARTS >> l->level, count = parts / parts_an_entry;
  uint32_t *entries = b->blocks + (size_t)block * OLX_VOLUME_BLOCK_ENTRIES;
  for (uint32_t i = 0; i < count * count * count; i++) {
    const uint32_t x = l->x / parts_an_entry % 4 + i % count, y = l->y / parts_an_entry % 4 + i / count % count,
                   z = l->z / parts_an_entry % 4 + i / (count * count);
    entries[x | y << 2 | z << 4] = entry;
  }
}

static olx_result put_entry(builder *b, const leaf *l, uint32_t entry) {
  const uint32_t x = l->x / PARTS, y = l->y / PARTS, z = l->z / PARTS;
  uint32_t *cube = &b->index[x + b->header.size[0] * (y + (size_t)b->header.size[1] * z)], block;
  if (l->level == 0) {
    *cube = entry;
    return OLX_OK;
  }
  OLX_TRY(block_at(b, cube, &block));
  if (l->level > 2) {
    const uint32_t at = (l->x / 4 % 4) | (l->y / 4 % 4) << 2 | (l->z / 4 % 4) << 4;
    uint32_t inner = b->blocks[(size_t)block * OLX_VOLUME_BLOCK_ENTRIES + at], number;
    OLX_TRY(block_at(b, &inner, &number));
    b->blocks[(size_t)block * OLX_VOLUME_BLOCK_ENTRIES + at] = inner;
    fill_block(b, number, l, 1, entry);
    return OLX_OK;
  }
  fill_block(b, block, l, 4, entry);
  return OLX_OK;
}

static olx_result add_leaves(builder *b) {
  for (uint32_t i = 0; i < b->leaf_count; i++) {
    const leaf *l = &b->leaves[i];
    const olx_volume_sides *sides = &b->sides[i];
    if (sides->root == 0) continue;
    const uint32_t first_cell = b->header.cells, first_split = b->header.splits;
    for (uint32_t k = 0; k < sides->split_count; k++) {
      olx_volume_split *split = &b->splits[b->header.splits++];
      *split = sides->splits[k];
      split->behind = global_entry(l, split->behind, first_cell, first_split);
      split->front = global_entry(l, split->front, first_cell, first_split);
    }
    for (uint32_t k = 0; k < sides->side_count; k++) OLX_TRY(add_side(b, l, &sides->sides[k]));
    OLX_TRY(put_entry(b, l, global_entry(l, sides->root, first_cell, first_split)));
  }
  return OLX_OK;
}

static char *append(char *at, const void *data, size_t size_bytes) {
  const char *bytes = data;
  for (size_t i = 0; i < size_bytes; i++) at[i] = bytes[i];
  return at + size_bytes;
}

static olx_result join(builder *b, olx_volume_cells *cells) {
  const olx_volume_header *h = &b->header;
  const size_t splits = h->splits * sizeof *b->splits, own = h->cells * sizeof *b->cells,
               blocks = (size_t)h->blocks * OLX_VOLUME_BLOCK_ENTRIES * sizeof *b->blocks,
               index = (size_t)h->size[0] * h->size[1] * h->size[2] * sizeof *b->index;
  cells->size_bytes = sizeof *h + splits + own + blocks + index;
  cells->data = olx_allocate(cells->size_bytes, 1);
  if (!cells->data) return out_of_memory();
  char *at = append(cells->data, h, sizeof *h);
  at = append(at, b->splits, splits);
  at = append(at, b->cells, own);
  at = append(at, b->blocks, blocks);
  append(at, b->index, index);
  cells->positions = b->positions;
  cells->probe_count = h->probes;
  cells->cell_count = h->cells;
  b->positions = NULL;
  return OLX_OK;
}

static olx_result build(builder *b, uint32_t threads, olx_volume_cells *cells) {
  OLX_TRY(divide_space(b));
  while (b->leaf_count > b->most_cells) {
    b->part *= 2.0f;
    OLX_TRY(divide_space(b));
  }
  OLX_TRY(find_all_sides(b, threads));
  OLX_TRY(halve_blind(b, threads));
  OLX_TRY(allocate_structure(b));
  OLX_TRY(add_leaves(b));
  return b->header.cells ? join(b, cells) : OLX_OK;
}

olx_result olx_volume_cells_create(const olx_volume_space *space, uint32_t along, uint32_t most_cells, uint32_t threads,
                                   olx_volume_cells *cells) {
  *cells = (olx_volume_cells){0};
  if (space->empty) return OLX_OK;
  const olx_vec3 extent = olx_sub(space->space.box.max, space->space.box.min);
  const float regular = olx_volume_least_metres(olx_max3(extent), along);
  builder b = {.space = space, .most_cells = most_cells, .part = regular / (float)(PARTS >> NEAR_LEVELS)};
  const olx_result result = build(&b, threads, cells);
  olx_cell_table_free(&b.corners);
  olx_cell_table_free(&b.chains);
  olx_release(b.leaves);
  olx_release(b.sides);
  olx_release(b.blind);
  olx_release(b.stand_ins);
  olx_release(b.positions);
  olx_release(b.index);
  olx_release(b.blocks);
  olx_release(b.splits);
  olx_release(b.cells);
  return result;
}

void olx_volume_cells_free(olx_volume_cells *cells) {
  olx_release(cells->data);
  olx_release(cells->positions);
  *cells = (olx_volume_cells){0};
}
