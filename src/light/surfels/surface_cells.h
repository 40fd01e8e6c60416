// Cells of surface: cubes of space with sides of powers of two, each with the surface in it that faces one way.
//
// The grid of cubes is fixed in the world, so that the position alone determines a cell. A cell's key is its Morton
// code below a leading one, which makes keys of all sizes distinct, above the bin of its normal.
#ifndef OLX_LIGHT_SURFACE_CELLS_H
#define OLX_LIGHT_SURFACE_CELLS_H

#include "core/vec.h"

enum {
  OLX_CELL_LEVELS = 17,  // sizes of cubes: from the scene's diagonal, rounded up to a power of two, down to 2^-16 of it
  OLX_CELL_BIN_BITS = 6, // 6 faces of a cube of normals, 3 x 3 bins each
  OLX_CELL_BINS_A_FACE = 9
};

typedef struct olx_cell_grid {
  olx_vec3 corner;        // low corner of all cubes, metres
  float finest, coarsest; // sides of the smallest and the largest cubes, metres: powers of two
} olx_cell_grid;

olx_cell_grid olx_cell_grid_make(olx_vec3 scene_min, olx_vec3 scene_max);

// Returns the key of the finest cell (level 0) at a point of a surface with that normal.
uint64_t olx_cell_key(const olx_cell_grid *grid, olx_vec3 position, olx_vec3 normal);

// Returns the key of the cell around another whose side is 2^levels times as long; for a finest cell, the one of that
// level.
static inline uint64_t olx_cell_at_level(uint64_t key, uint32_t levels) {
  const uint64_t bin = key & ((1u << OLX_CELL_BIN_BITS) - 1);
  return ((key >> OLX_CELL_BIN_BITS) >> (3 * levels)) << OLX_CELL_BIN_BITS | bin;
}

// Returns a sort key of a cell: in this order, the cells of one size within a larger cell are consecutive. In the order
// of the keys themselves, surfaces that face other ways would come between them.
static inline uint64_t olx_cell_order(uint64_t key) {
  return key << (64 - OLX_CELL_BIN_BITS) | key >> OLX_CELL_BIN_BITS;
}

static inline float olx_cell_side(const olx_cell_grid *grid, uint32_t level) {
  return ldexpf(grid->finest, (int)level);
}

// Returns the level of cells with a side in metres, which is one of theirs.
static inline uint32_t olx_cell_level(const olx_cell_grid *grid, float side) {
  return (uint32_t)ilogbf(side / grid->finest);
}

// Returns the centre of the cube of `level` that holds a point.
olx_vec3 olx_cell_middle(const olx_cell_grid *grid, olx_vec3 position, uint32_t level);

// A table from cells to values below OLX_CELL_NONE. Any number of threads may read while no thread adds.
typedef struct olx_cell_table {
  uint64_t *keys; // 0: free
  uint32_t *values;
  uint32_t capacity, count; // capacity: a power of two
} olx_cell_table;

#define OLX_CELL_NONE UINT32_MAX

olx_result olx_cell_table_create(olx_cell_table *table, uint32_t expected);
void olx_cell_table_free(olx_cell_table *table);
// Sets the value of a cell, adding the cell when it is missing. Fails when memory runs out.
olx_result olx_cell_table_set(olx_cell_table *table, uint64_t key, uint32_t value);
// Returns the value of a cell; OLX_CELL_NONE when it is not in the table, and for key 0, which is no cell's.
uint32_t olx_cell_table_get(const olx_cell_table *table, uint64_t key);

#endif
