// Assigns keys to the cells of surface for which light is gathered, and looks them up: Morton codes of cubes that are
// fixed in the world, bins of normals, and a hash table over both.
#include "light/surfels/surface_cells.h"

#include "core/hooks.h"
#include "core/morton.h"
#include "core/result.h"

enum { AXIS_BITS = OLX_CELL_LEVELS + 1 };

static float power_of_two_above(float length) {
  int exponent;
  frexpf(length, &exponent);
  return ldexpf(1.0f, exponent);
}

olx_cell_grid olx_cell_grid_make(olx_vec3 scene_min, olx_vec3 scene_max) {
  const float side = power_of_two_above(olx_max(olx_length(olx_sub(scene_max, scene_min)), 1e-18f));
  return (olx_cell_grid){
      .corner = olx_v3(floorf(scene_min.x / side) * side, floorf(scene_min.y / side) * side,
                       floorf(scene_min.z / side) * side),
      .finest = ldexpf(side, 1 - OLX_CELL_LEVELS),
      .coarsest = side,
  };
}

static uint32_t cell_coordinate(float from_corner, float finest) {
  return (uint32_t)olx_clamp(from_corner / finest, 0.0f, (float)((1u << AXIS_BITS) - 1));
}

static uint32_t third(float x) { return x < -1.0f / 3.0f ? 0 : x > 1.0f / 3.0f ? 2 : 1; }

// Returns the bin of a normal: the face of the cube that it points through, and which ninth of that face; normals along
// the axes lie in the middle.
static uint32_t normal_bin(olx_vec3 n) {
  const float x = fabsf(n.x), y = fabsf(n.y), z = fabsf(n.z);
  if (x >= y && x >= z) return (n.x < 0.0f) * OLX_CELL_BINS_A_FACE + third(n.y / x) * 3 + third(n.z / x);
  if (y >= z) return (2 + (n.y < 0.0f)) * OLX_CELL_BINS_A_FACE + third(n.x / y) * 3 + third(n.z / y);
  return (4 + (n.z < 0.0f)) * OLX_CELL_BINS_A_FACE + third(n.x / z) * 3 + third(n.y / z);
}

uint64_t olx_cell_key(const olx_cell_grid *grid, olx_vec3 position, olx_vec3 normal) {
  const olx_vec3 p = olx_sub(position, grid->corner);
  const uint64_t code = olx_morton_spread(cell_coordinate(p.x, grid->finest)) |
                        olx_morton_spread(cell_coordinate(p.y, grid->finest)) << 1 |
                        olx_morton_spread(cell_coordinate(p.z, grid->finest)) << 2;
  return (code | UINT64_C(1) << (3 * AXIS_BITS)) << OLX_CELL_BIN_BITS | normal_bin(normal);
}

olx_vec3 olx_cell_middle(const olx_cell_grid *grid, olx_vec3 position, uint32_t level) {
  const float side = olx_cell_side(grid, level);
  const olx_vec3 p = olx_scale(olx_sub(position, grid->corner), 1.0f / side);
  const olx_vec3 middle = olx_v3(floorf(p.x) + 0.5f, floorf(p.y) + 0.5f, floorf(p.z) + 0.5f);
  return olx_madd(grid->corner, middle, side);
}

static uint32_t slot_of(uint64_t key, uint32_t capacity) {
  return (uint32_t)((key * UINT64_C(0x9E3779B97F4A7C15)) >> 32) & (capacity - 1);
}

olx_result olx_cell_table_create(olx_cell_table *table, uint32_t expected) {
  uint32_t capacity = 64;
  while (capacity < 2 * (uint64_t)expected) capacity *= 2;
  *table = (olx_cell_table){.keys = olx_allocate_zero(capacity, sizeof *table->keys),
                            .values = olx_allocate(capacity, sizeof *table->values),
                            .capacity = capacity};
  if (table->keys && table->values) return OLX_OK;
  olx_cell_table_free(table);
  return olx_fail(OLX_ERROR_MEMORY, "light: out of memory for a table of %u cells", expected);
}

void olx_cell_table_free(olx_cell_table *table) {
  olx_release(table->keys);
  olx_release(table->values);
  *table = (olx_cell_table){0};
}

// Returns the slot that holds the key, or the free one where it belongs.
static uint32_t find_slot(const olx_cell_table *table, uint64_t key) {
  uint32_t slot = slot_of(key, table->capacity);
  while (table->keys[slot] != 0 && table->keys[slot] != key) slot = (slot + 1) & (table->capacity - 1);
  return slot;
}

static olx_result grow(olx_cell_table *table) {
  olx_cell_table larger;
  OLX_TRY(olx_cell_table_create(&larger, table->capacity));
  for (uint32_t i = 0; i < table->capacity; i++) {
    if (table->keys[i] == 0) continue;
    const uint32_t slot = find_slot(&larger, table->keys[i]);
    larger.keys[slot] = table->keys[i];
    larger.values[slot] = table->values[i];
  }
  larger.count = table->count;
  olx_cell_table_free(table);
  *table = larger;
  return OLX_OK;
}

olx_result olx_cell_table_set(olx_cell_table *table, uint64_t key, uint32_t value) {
  if (2 * (uint64_t)table->count >= table->capacity) OLX_TRY(grow(table));
  const uint32_t slot = find_slot(table, key);
  if (table->keys[slot] == 0) table->count++;
  table->keys[slot] = key;
  table->values[slot] = value;
  return OLX_OK;
}

uint32_t olx_cell_table_get(const olx_cell_table *table, uint64_t key) {
  const uint32_t slot = find_slot(table, key);
  return key != 0 && table->keys[slot] == key ? table->values[slot] : OLX_CELL_NONE;
}
