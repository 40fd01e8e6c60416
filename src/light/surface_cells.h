// Cells of surface: cubes of space, in sizes of powers of two, each with the surface in it that faces one way.
//
// The grid of cubes is fixed in the world, so that a cell is named by its place alone. A cell's key is its Morton code
// below a leading one, so that keys of all sizes differ, above the bin that its normal falls into.
#ifndef OLX_LIGHT_SURFACE_CELLS_H
#define OLX_LIGHT_SURFACE_CELLS_H

#include "core/vec.h"

enum {
  OLX_CELL_LEVELS = 17,  // sizes of cubes: the scene's diagonal, rounded up to a power of two, and down to 2^-16 of it
  OLX_CELL_BIN_BITS = 6, // 6 faces of a cube of normals by 3 x 3
  OLX_CELL_BINS_A_FACE = 9
};

typedef struct olx_cell_grid {
  olx_vec3 corner;        // of all cubes, metres
  float finest, coarsest; // sides of the smallest and the largest cubes, metres: powers of two
} olx_cell_grid;

olx_cell_grid olx_cell_grid_make(olx_vec3 scene_min, olx_vec3 scene_max);

// The cell of the finest size (level 0) at a point of a surface with that normal.
uint64_t olx_cell_key(const olx_cell_grid *grid, olx_vec3 position, olx_vec3 normal);

// The cell that holds another and whose side is 2^levels times as long; of a finest cell, the one of that level.
static inline uint64_t olx_cell_at_level(uint64_t key, uint32_t levels) {
  const uint64_t bin = key & ((1u << OLX_CELL_BIN_BITS) - 1);
  return ((key >> OLX_CELL_BIN_BITS) >> (3 * levels)) << OLX_CELL_BIN_BITS | bin;
}

// Cells of one size that lie in a larger cell follow each other in this order of their keys; in that of the keys
// themselves surfaces that face other ways come between them.
static inline uint64_t olx_cell_order(uint64_t key) { return key << (64 - OLX_CELL_BIN_BITS) | key >> OLX_CELL_BIN_BITS; }

static inline float olx_cell_side(const olx_cell_grid *grid, uint32_t level) {
  return ldexpf(grid->finest, (int)level);
}

// The middle of the cube of `level` that a point lies in.
olx_vec3 olx_cell_middle(const olx_cell_grid *grid, olx_vec3 position, uint32_t level);

// A table from cells to numbers below OLX_CELL_NONE. Any number of threads may look up while no thread adds.
typedef struct olx_cell_table {
  uint64_t *keys; // 0: free
  uint32_t *values;
  uint32_t capacity, count; // capacity: a power of two
} olx_cell_table;

#define OLX_CELL_NONE UINT32_MAX

olx_result olx_cell_table_create(olx_cell_table *table, uint32_t expected);
void olx_cell_table_free(olx_cell_table *table);
// Sets the number of a cell, adding the cell when it is not in the table. Fails when memory is out.
olx_result olx_cell_table_set(olx_cell_table *table, uint64_t key, uint32_t value);
// OLX_CELL_NONE when the cell is not in the table.
uint32_t olx_cell_table_get(const olx_cell_table *table, uint64_t key);

#endif
