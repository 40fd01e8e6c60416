// All voxels of a scene, of any size: bricks that a surface touches are stored, open ones are not. Space is flooded
// here as a whole; code that needs single voxels opens a window of them (space.h).
#ifndef OLX_PLACE_WORLD_H
#define OLX_PLACE_WORLD_H

#include "place/space/voxel_marks.h"

enum { OLX_WORLD_SIDE = 8 };

// A bit per voxel: bit x + 8 * y of element z is voxel (x, y, z) of a brick.
typedef struct olx_world_bits {
  uint64_t z[OLX_WORLD_SIDE];
} olx_world_bits;

// `out`: excluded from the flood, as if it were solid. `seen`: flooded earlier, in the search for connected spaces.
typedef struct olx_world_brick {
  olx_world_bits solid, out, reached, seen;
} olx_world_brick;

typedef struct olx_world {
  const olx_scene *scene;
  olx_box box;         // the box of interest: voxels cover it, the last of them only in part
  olx_lattice lattice; // of voxels
  uint32_t begin[3];   // voxels before these along each axis are beyond the box, and solid
  uint32_t bricks[3], brick_total;
  uint32_t *slots;         // per brick: its index in `stored`, or OLX_OPEN_BRICK
  uint8_t *flags;          // per brick: what its voxels have in common, where it is open
  olx_world_brick *stored; // bricks that a surface touches, in which the lattice ends, or that are excluded in part
  uint32_t stored_count, stored_capacity;
  uint32_t *queue, *touched; // bricks from which to flood, and those that the last flood reached
  uint32_t queue_count, touched_count;
  uint64_t reached_count; // number of voxels of the space that matters, once it is found
  int32_t outside;        // depth for olx_depth_is_inside
  // Tiles are cubes of tile_edge voxels, the first of which begin `shift` voxels before the lattice.
  uint32_t tile_edge, shift[3], tiles[3], tile_total;
  int32_t first_tile[3]; // index of the first tile along each axis, among all tiles of space
} olx_world;

// Voxels [from, to) of a tile and its surroundings.
typedef struct olx_tile {
  uint32_t index, cell[3]; // cell: indices of the tile along each axis
  uint32_t core_from[3], core_to[3], from[3], to[3];
} olx_tile;

// Returns the tile with this many voxels around it, as far as they exist.
olx_tile olx_world_tile(const olx_world *world, uint32_t index, uint32_t overlap);
// Returns the diagonal in metres of the scene's bounds, or of a tile where there are many.
float olx_world_diagonal(const olx_world *world);
// Returns the tile that holds the point, or the nearest to it.
uint32_t olx_world_tile_of(const olx_world *world, olx_vec3 p);
// Divides the world into tiles of `tile_edge` voxels. `first` is the index of the world's first voxel among all voxels
// of space; both are multiples of OLX_WORLD_SIDE. A new world is one tile.
void olx_world_cut(olx_world *world, uint32_t tile_edge, const int32_t first[3]);

#define OLX_OPEN_BRICK UINT32_MAX
#define OLX_WORLD_BRICKS (1u << 23) // most bricks
#define OLX_WORLD_STORED (1u << 21) // most stored bricks before any is excluded in part

typedef enum olx_voxel_state {
  OLX_VOXEL_NONE, // beyond the voxels
  OLX_VOXEL_SOLID,
  OLX_VOXEL_OUT,     // free, but excluded
  OLX_VOXEL_CUT_OFF, // free, but not reached
  OLX_VOXEL_REACHED
} olx_voxel_state;

// Creates the voxels of the lattice, from `begin` on; those that a surface touches are solid. Returns
// OLX_ERROR_ARGUMENT when there would be more bricks than OLX_WORLD_BRICKS and OLX_WORLD_STORED allow.
olx_result olx_world_create(const olx_scene *scene, olx_box box, const olx_lattice *lattice, const uint32_t begin[3],
                            uint32_t threads, olx_world *world);
void olx_world_free(olx_world *world);

// Returns the number of bricks that cover this many voxels.
uint64_t olx_world_brick_count(const uint32_t voxels[3]);

// Finds the voxel that holds the point; false beyond all voxels.
bool olx_world_at(const olx_world *world, olx_vec3 p, uint32_t voxel[3]);
// Finds the voxel that holds the point, or the nearest to it.
void olx_world_nearest(const olx_world *world, olx_vec3 p, uint32_t voxel[3]);
olx_vec3 olx_world_centre(const olx_world *world, const uint32_t voxel[3]);
olx_voxel_state olx_world_state(const olx_world *world, const uint32_t voxel[3]);

// Marks as reached what is connected with the voxel through faces of voxels that are neither solid nor excluded.
// Returns how many voxels of the visited bricks are reached then; 0 when the voxel itself cannot be reached or is
// already.
uint64_t olx_world_flood(olx_world *world, const uint32_t voxel[3]);
// Clears what is reached and seen.
void olx_world_forget(olx_world *world);
// Turns what the last flood reached into seen.
void olx_world_put_aside(olx_world *world);
// Finds the next free voxel, in the order of bricks from *brick on, that is neither seen, reached nor excluded. Returns
// false when there is none.
bool olx_world_next_free(const olx_world *world, uint32_t *brick, uint32_t voxel[3]);
// Finds the `nth` voxel that the last flood reached, in the order of its bricks.
bool olx_world_nth_reached(const olx_world *world, uint64_t nth, uint32_t voxel[3]);
// Finds up to `wanted` centres of reached voxels, evenly spread over all of them once reached_count is known. Returns
// their number.
uint32_t olx_world_spread(const olx_world *world, uint32_t wanted, olx_vec3 *centres);
// Counts voxels that are reached, and those that are free.
uint64_t olx_world_count_reached(const olx_world *world);
bool olx_world_has_free(const olx_world *world);

// Excludes voxels from later floods: those whose bits are set, of the brick that holds the voxel.
olx_result olx_world_leave_out(olx_world *world, const uint32_t voxel[3], const olx_world_bits *bits);
// Excludes the connected free spaces that are not reached, except those for which `keeps` returns true. It is called
// for each with only that space reached, and with its number of voxels.
typedef bool (*olx_world_keeps)(void *user, const olx_world *world, uint64_t size);
olx_result olx_world_sift(olx_world *world, olx_world_keeps keeps, void *user);
// Includes everything again.
void olx_world_take_back(olx_world *world);

#endif
